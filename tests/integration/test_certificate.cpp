#include "tests/integration/test_certificate.h"

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <cstdio>
#include <memory>
#include <stdexcept>

namespace obliq::test {
namespace {

void check(bool ok, const char* what) {
  if (!ok) throw std::runtime_error(std::string("test certificate: ") + what);
}

template <typename Write>
void write_pem(const std::filesystem::path& path, Write write) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), std::fclose);
  check(file != nullptr && write(file.get()) == 1, "cannot be written");
  chmod(path.c_str(), 0600);
}

}  // namespace

TestCertificate make_certificate(const std::filesystem::path& folder, const std::string& name,
                                 const std::string& names, int from_days, int to_days) {
  const TestCertificate made{folder / (name + ".pem"), folder / (name + ".key")};
  const std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)> key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  const std::unique_ptr<X509, void (*)(X509*)> certificate(X509_new(), X509_free);
  check(key && certificate, "no key");
  X509* x = certificate.get();
  X509_set_version(x, X509_VERSION_3);
  // A number of its own: two certificates of one issuer with the same would be refused.
  ASN1_INTEGER_set_uint64(X509_get_serialNumber(x), std::hash<std::string>{}(made.key.string()) >> 1);
  X509_gmtime_adj(X509_getm_notBefore(x), 86400L * from_days);
  X509_gmtime_adj(X509_getm_notAfter(x), 86400L * to_days);
  X509_set_pubkey(x, key.get());
  X509_NAME* subject = X509_get_subject_name(x);
  X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1, 0);
  X509_set_issuer_name(x, subject);
  const std::unique_ptr<X509_EXTENSION, void (*)(X509_EXTENSION*)> extension(
      X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, names.c_str()), X509_EXTENSION_free);
  check(extension && X509_add_ext(x, extension.get(), -1) == 1, "no names");
  check(X509_sign(x, key.get(), EVP_sha256()) > 0, "not signed");
  write_pem(made.certificate, [&](std::FILE* file) { return PEM_write_X509(file, x); });
  write_pem(made.key, [&](std::FILE* file) {
    return PEM_write_PrivateKey(file, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
  });
  return made;
}

}  // namespace obliq::test
