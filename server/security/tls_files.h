#pragma once
#include <memory>
#include <string>
#include <vector>

namespace boost::asio::ssl {
class context;
}

namespace obliq::net {

/// A server's TLS, 1.2 and later, from PEM files. Throws InputError that names key, file and reason.
/// Warnings: a certificate that has expired or is not valid yet, a key that others may read.
std::shared_ptr<boost::asio::ssl::context> read_tls_files(const std::string& certificate_path,
                                                          const std::string& key_path,
                                                          std::vector<std::string>& warnings);

}  // namespace obliq::net
