#pragma once
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/security/token_file.h"

namespace boost::asio::ssl {
class context;
}

namespace obliq::security {

/// Paths; an empty one: not configured.
struct SecurityFiles {
  std::string tokens;
  std::string tls_certificate;  ///< PEM, the chain with the server's own first
  std::string tls_key;          ///< PEM
};

/// Tokens and roles, and the certificate of the server: shared by all ports of the daemon.
/// From any thread.
class Security {
 public:
  /// Nothing configured: no TLS, and every client is admin.
  Security() = default;
  /// Reads the files. Throws InputError that names file and reason.
  explicit Security(SecurityFiles files);

  struct Reloaded {
    std::string tokens_fault;  ///< empty: they are in force, or none are configured
    std::string certificate_fault;
  };
  /// Reads the files anew, each by itself: where one is faulty, the old one stays in force.
  Reloaded reload();

  bool needs_token() const { return !files_.tokens.empty(); }
  bool has_tls() const { return !files_.tls_certificate.empty(); }

  /// Nothing: refused. Where no tokens are configured, an admin, whatever the token.
  std::optional<Grant> grant(std::string_view token) const;
  /// As above, for a client that came earlier: what the same token grants now.
  std::optional<Grant> grant(const TokenDigest& digest) const;

  /// For new connections; null without TLS. Existing ones keep theirs.
  std::shared_ptr<boost::asio::ssl::context> tls() const;
  /// When the certificate in use ends, seconds since 1970; infinite without one.
  double certificate_end_s() const;
  /// About the certificate in use: that it has expired, say.
  std::vector<std::string> warnings() const;

 private:
  /// Never changes once made.
  struct Material {
    std::optional<TokenFile> tokens;
    std::shared_ptr<boost::asio::ssl::context> tls;
    double certificate_end_s = std::numeric_limits<double>::infinity();
    std::vector<std::string> warnings;
  };
  std::shared_ptr<const Material> current() const;

  SecurityFiles files_;
  mutable std::mutex mutex_;  ///< guards material_
  std::shared_ptr<const Material> material_ = std::make_shared<const Material>();
};

}  // namespace obliq::security
