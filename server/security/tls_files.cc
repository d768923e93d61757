#include "server/security/tls_files.h"

#include <openssl/pem.h>
#include <openssl/x509.h>

#include <memory>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "server/security/small_file.h"

namespace lipofill::server {
namespace {

struct Free {
  void operator()(BIO* bio) const { BIO_free_all(bio); }
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
using Bio = std::unique_ptr<BIO, Free>;
using Certificate = std::unique_ptr<X509, Free>;
using Key = std::unique_ptr<EVP_PKEY, Free>;

/// A key with a passphrase has nobody who could type it.
int no_passphrase(char*, int, int, void*) {
  return -1;
}

std::string read(const char* setting, const std::string& path, FieldViolations& violations) {
  const auto text = read_small_file(path);
  if (!text.ok()) violations.add(setting, absl::StrCat("is ", std::string(text.status().message())));
  return text.value_or("");
}

Bio open(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

/// The first certificate of a file; nullptr once it was said what is wrong.
Certificate read_certificate(const char* setting, const std::string& path, FieldViolations& violations) {
  const std::string text = read(setting, path, violations);
  if (text.empty()) return nullptr;
  Certificate certificate(PEM_read_bio_X509(open(text).get(), nullptr, no_passphrase, nullptr));
  if (certificate == nullptr) {
    violations.add(setting, absl::StrCat("is \"", path, "\", which has no PEM block CERTIFICATE"));
  } else if (X509_cmp_current_time(X509_get0_notAfter(certificate.get())) <= 0) {
    violations.add(setting, absl::StrCat("is \"", path, "\", whose certificate has expired"));
  }
  return certificate;
}

void check_key(const std::string& path, X509* certificate, FieldViolations& violations) {
  constexpr char kSetting[] = "tls-key-file";
  const std::string text = read(kSetting, path, violations);
  if (text.empty()) return;
  const Key key(PEM_read_bio_PrivateKey(open(text).get(), nullptr, no_passphrase, nullptr));
  if (key == nullptr) {
    violations.add(kSetting,
                   absl::StrCat("is \"", path, "\", which has no PEM block PRIVATE KEY without a passphrase"));
  } else if (certificate != nullptr && X509_check_private_key(certificate, key.get()) != 1) {
    violations.add(kSetting, absl::StrCat("is \"", path, "\", which is not the key of tls-certificate-file"));
  }
}

}  // namespace

absl::Status check_tls_files(const SecuritySettings& settings) {
  FieldViolations violations;
  Certificate certificate;
  if (settings.has_tls()) {
    certificate = read_certificate("tls-certificate-file", settings.tls_certificate_file, violations);
  }
  if (!settings.tls_key_file.empty()) check_key(settings.tls_key_file, certificate.get(), violations);
  if (!settings.tls_client_ca_file.empty()) {
    read_certificate("tls-client-ca-file", settings.tls_client_ca_file, violations);
  }
  return violations.to_status();
}

}  // namespace lipofill::server
