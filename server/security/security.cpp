#include "server/security/security.h"

#include <utility>

#include "server/security/tls_files.h"
#include "terrain/base/errors.h"

namespace obliq::net {

Security::Security(SecurityFiles files) : files_(std::move(files)) {
  if (files_.tls_certificate.empty() != files_.tls_key.empty()) {
    throw InputError(
        files_.tls_key.empty()
            ? "server.tls_key: found nothing; allowed: the key of server.tls_certificate"
            : "server.tls_certificate: found nothing; allowed: the certificate of server.tls_key");
  }
  const Reloaded first = reload();
  for (const std::string& fault : {first.tokens_fault, first.certificate_fault})
    if (!fault.empty()) throw InputError(fault);
}

Security::Reloaded Security::reload() {
  Reloaded reloaded;
  auto material = std::make_shared<Material>(*current());
  try {
    if (needs_token()) material->tokens = TokenFile::read(files_.tokens);
  } catch (const InputError& e) {
    reloaded.tokens_fault = e.what();
  }
  try {
    std::vector<std::string> warnings;
    if (has_tls()) material->tls = read_tls_files(files_.tls_certificate, files_.tls_key, warnings);
    material->warnings = std::move(warnings);
  } catch (const InputError& e) {
    reloaded.certificate_fault = e.what();
  }
  const std::lock_guard lock(mutex_);
  material_ = std::move(material);
  return reloaded;
}

std::shared_ptr<const Security::Material> Security::current() const {
  const std::lock_guard lock(mutex_);
  return material_;
}

std::optional<Grant> Security::grant(std::string_view token) const {
  const auto material = current();
  return material->tokens ? material->tokens->find(token) : Grant{Role::admin, "", {}};
}

std::optional<Grant> Security::grant(const TokenDigest& digest) const {
  const auto material = current();
  return material->tokens ? material->tokens->find(digest) : Grant{Role::admin, "", {}};
}

std::shared_ptr<boost::asio::ssl::context> Security::tls() const { return current()->tls; }

std::vector<std::string> Security::warnings() const { return current()->warnings; }

}  // namespace obliq::net
