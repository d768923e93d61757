#include "server/security/anchor_key.h"

#include <openssl/evp.h>
#include <openssl/pem.h>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "server/security/small_file.h"

namespace lipofill::server {
namespace {

using Bio = std::unique_ptr<BIO, decltype(&BIO_free_all)>;
using Context = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

Context make_context() {
  return {EVP_MD_CTX_new(), &EVP_MD_CTX_free};
}

/// Ed25519 signs the text itself, the others its SHA-256.
const EVP_MD* digest_for(EVP_PKEY* key) {
  return EVP_PKEY_is_a(key, "ED25519") == 1 ? nullptr : EVP_sha256();
}

const unsigned char* bytes_of(const std::string& text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

/// A key that is locked by a password cannot be used: nobody is there to be asked.
int no_password(char*, int, int, void*) {
  return 0;
}

std::shared_ptr<EVP_PKEY> hold(EVP_PKEY* key) {
  return key == nullptr ? nullptr : std::shared_ptr<EVP_PKEY>(key, EVP_PKEY_free);
}

std::shared_ptr<EVP_PKEY> read_key(const std::string& text, bool is_private) {
  const Bio memory(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), &BIO_free_all);
  return hold(is_private ? PEM_read_bio_PrivateKey(memory.get(), nullptr, no_password, nullptr)
                         : PEM_read_bio_PUBKEY(memory.get(), nullptr, nullptr, nullptr));
}

}  // namespace

absl::StatusOr<AnchorKey> AnchorKey::open(const std::string& path) {
  const auto text = read_small_file(path);
  if (!text.ok()) return text.status();
  auto key = read_key(*text, true);
  if (key == nullptr) return absl::InvalidArgumentError(absl::StrCat(path, " has no private key without a password"));
  AnchorKey opened(std::move(key));
  if (opened.sign("a trial").empty())
    return absl::InvalidArgumentError(absl::StrCat(path, " has a key that cannot sign"));
  return opened;
}

absl::StatusOr<AnchorKey> AnchorKey::open_to_verify(const std::string& path) {
  const auto text = read_small_file(path);
  if (!text.ok()) return text.status();
  auto key = read_key(*text, false);
  if (key == nullptr) key = read_key(*text, true);
  if (key == nullptr) return absl::InvalidArgumentError(absl::StrCat(path, " has no PEM block of a key"));
  return AnchorKey(std::move(key));
}

std::string AnchorKey::sign(const std::string& text) const {
  const Context context = make_context();
  size_t size = 0;
  if (EVP_DigestSignInit(context.get(), nullptr, digest_for(key_.get()), nullptr, key_.get()) != 1 ||
      EVP_DigestSign(context.get(), nullptr, &size, bytes_of(text), text.size()) != 1) {
    return "";
  }
  std::string signature(size, '\0');
  auto* out = reinterpret_cast<unsigned char*>(signature.data());
  if (EVP_DigestSign(context.get(), out, &size, bytes_of(text), text.size()) != 1) return "";
  signature.resize(size);
  return absl::Base64Escape(signature);
}

bool AnchorKey::has_signed(const std::string& text, const std::string& signature) const {
  std::string bytes;
  if (!absl::Base64Unescape(signature, &bytes) || bytes.empty()) return false;
  const Context context = make_context();
  return EVP_DigestVerifyInit(context.get(), nullptr, digest_for(key_.get()), nullptr, key_.get()) == 1 &&
         EVP_DigestVerify(context.get(), bytes_of(bytes), bytes.size(), bytes_of(text), text.size()) == 1;
}

}  // namespace lipofill::server
