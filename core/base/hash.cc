#include "core/base/hash.h"

#include <openssl/evp.h>

#include <array>
#include <new>

namespace lipofill {

struct Hasher::State {
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

Hasher::Hasher() : state_(std::make_unique<State>()) {
  if (state_->context == nullptr || EVP_DigestInit_ex(state_->context.get(), EVP_sha256(), nullptr) != 1) {
    throw std::bad_alloc();
  }
}

Hasher::~Hasher() = default;

void Hasher::add_bytes(const void* data, size_t size) {
  EVP_DigestUpdate(state_->context.get(), data, size);
}

void Hasher::add(std::string_view text) {
  add(static_cast<uint64_t>(text.size()));
  add_bytes(text.data(), text.size());
}

std::string Hasher::hex_digest() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
  unsigned int size = 0;
  EVP_DigestFinal_ex(state_->context.get(), digest.data(), &size);
  constexpr char kHex[] = "0123456789abcdef";
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    text += kHex[digest[i] >> 4];
    text += kHex[digest[i] & 15];
  }
  return text;
}

}  // namespace lipofill
