#include "server/security/security.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <sys/stat.h>

#include <boost/asio/ssl/context.hpp>
#include <cerrno>
#include <cstdio>
#include <ctime>
#include <system_error>
#include <utility>

#include "terrain/base/errors.h"
#include "terrain/base/files.h"

namespace obliq::security {
namespace {

namespace ssl = boost::asio::ssl;

/// From here on a handshake takes a millisecond and more of one core (`openssl speed`: 2048 bits 0.4 ms,
/// 3072 2.1 ms, 4096 4.6 ms).
constexpr int kSlowRsa_bits = 3072;

/// OpenSSL's reason for the last error, which is cleared.
std::string openssl_reason() {
  const unsigned long code = ERR_peek_last_error();
  ERR_clear_error();
  const char* reason = ERR_reason_error_string(code);
  return reason == nullptr ? "not readable as PEM" : reason;
}

/// OpenSSL's message for a missing file is unreadable.
void demand_readable(const std::string& key, const std::string& path) {
  refuse_endless_file(key + ": " + path, path);
  std::FILE* file = std::fopen(path.c_str(), "rbe");
  if (file == nullptr) throw InputError(key + ": " + path + ": " + std::system_category().message(errno));
  std::fclose(file);
}

/// A daemon has no terminal for a passphrase and must not wait for one.
int no_passphrase(char*, int, int, void*) { return -1; }

std::string time_text(const ASN1_TIME* time) {
  tm parts{};
  char text[32] = "?";
  if (ASN1_TIME_to_tm(time, &parts) == 1) std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &parts);
  return text;
}

double seconds_since_1970(const ASN1_TIME* time) {
  tm parts{};
  return ASN1_TIME_to_tm(time, &parts) == 1 ? static_cast<double>(timegm(&parts))
                                            : std::numeric_limits<double>::infinity();
}

/// A server's TLS, 1.2 and later, from PEM files. Throws InputError that names key, file and reason.
/// Warnings: a certificate that has expired or is not valid yet, a key that others may read.
std::shared_ptr<ssl::context> read_tls_files(const std::string& certificate_path, const std::string& key_path,
                                             std::vector<std::string>& warnings) {
  demand_readable("server.tls_certificate", certificate_path);
  demand_readable("server.tls_key", key_path);
  auto context = std::make_shared<ssl::context>(ssl::context::tls_server);
  SSL_CTX* tls = context->native_handle();
  SSL_CTX_set_min_proto_version(tls, TLS1_2_VERSION);
  // A peer could ask for renegotiation again and again. A peer that closes without close_notify is no error:
  // messages have a length and a CRC of their own.
  SSL_CTX_set_options(tls, SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE |
                               SSL_OP_IGNORE_UNEXPECTED_EOF);
  SSL_CTX_set_mode(tls, SSL_MODE_RELEASE_BUFFERS);  // idle connections hold 34 KiB less
  SSL_CTX_set_default_passwd_cb(tls, no_passphrase);
  ERR_clear_error();
  if (SSL_CTX_use_certificate_chain_file(tls, certificate_path.c_str()) != 1)
    throw InputError("server.tls_certificate: " + certificate_path + ": " + openssl_reason() +
                     "; allowed: a PEM file with the server's certificate first, then its issuers");
  if (SSL_CTX_use_PrivateKey_file(tls, key_path.c_str(), SSL_FILETYPE_PEM) != 1) {
    const bool other_key = ERR_GET_REASON(ERR_peek_last_error()) == X509_R_KEY_VALUES_MISMATCH;
    const std::string reason = openssl_reason();
    if (other_key)
      throw InputError("server.tls_key: " + key_path + ": is not the key of the certificate in " +
                       certificate_path);
    throw InputError("server.tls_key: " + key_path + ": " + reason +
                     "; allowed: a PEM file with a private key, without passphrase");
  }
  if (SSL_CTX_check_private_key(tls) != 1) {
    ERR_clear_error();
    throw InputError("server.tls_key: " + key_path + ": is not the key of the certificate in " +
                     certificate_path);
  }
  const X509* certificate = SSL_CTX_get0_certificate(tls);
  if (X509_cmp_current_time(X509_get0_notAfter(certificate)) < 0) {
    warnings.push_back("server.tls_certificate: " + certificate_path + " expired on " +
                       time_text(X509_get0_notAfter(certificate)) +
                       "; clients that check it will not connect: renew it, then send SIGHUP");
  } else if (X509_cmp_current_time(X509_get0_notBefore(certificate)) > 0) {
    warnings.push_back("server.tls_certificate: " + certificate_path + " is not valid before " +
                       time_text(X509_get0_notBefore(certificate)) + "; check this machine's clock");
  }
  const EVP_PKEY* key = X509_get0_pubkey(certificate);
  if (EVP_PKEY_base_id(key) == EVP_PKEY_RSA && EVP_PKEY_bits(key) >= kSlowRsa_bits)
    warnings.push_back(
        "server.tls_certificate: " + certificate_path + " has an RSA key of " +
        std::to_string(EVP_PKEY_bits(key)) +
        " bits: every handshake costs milliseconds of processor time, which a flood of connections "
        "multiplies; a key on the curve P-256 (openssl ecparam -genkey -name prime256v1) costs a tenth");
  struct stat status {};
  if (::stat(key_path.c_str(), &status) == 0 && (status.st_mode & S_IRWXO) != 0)
    warnings.push_back("server.tls_key: " + key_path +
                       " may be read by every user of this machine: chmod 600");
  return context;
}

}  // namespace

Security::Security(SecurityFiles files) : files_(std::move(files)) {
  if (files_.tls_certificate.empty() != files_.tls_key.empty())
    throw InputError(
        files_.tls_key.empty()
            ? "server.tls_key: found nothing; allowed: the key of server.tls_certificate"
            : "server.tls_certificate: found nothing; allowed: the certificate of server.tls_key");
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
    if (has_tls()) {
      material->tls = read_tls_files(files_.tls_certificate, files_.tls_key, warnings);
      material->certificate_end_s =
          seconds_since_1970(X509_get0_notAfter(SSL_CTX_get0_certificate(material->tls->native_handle())));
    }
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

double Security::certificate_end_s() const { return current()->certificate_end_s; }

std::vector<std::string> Security::warnings() const { return current()->warnings; }

}  // namespace obliq::security
