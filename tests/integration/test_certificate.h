#pragma once
#include <filesystem>
#include <string>

namespace obliq::test {

struct TestCertificate {
  std::filesystem::path certificate;  ///< PEM; signed by itself: also what a client may trust
  std::filesystem::path key;          ///< PEM, mode 600
};

/// A new key and a certificate for it in `folder`. `names` as OpenSSL has them: "IP:127.0.0.1,DNS:localhost".
/// Valid from `from_days` to `to_days` from now.
TestCertificate make_certificate(const std::filesystem::path& folder, const std::string& name,
                                 const std::string& names = "IP:127.0.0.1,DNS:localhost", int from_days = -1,
                                 int to_days = 1);

}  // namespace obliq::test
