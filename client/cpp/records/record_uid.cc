#include "client/cpp/records/record_uid.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>

#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

using Uuid = std::array<unsigned char, 16>;

/// The number in decimal, by long division.
std::string decimal_of(Uuid number) {
  std::string digits;
  const auto is_zero = [&number] { return std::all_of(number.begin(), number.end(), [](auto b) { return b == 0; }); };
  while (!is_zero()) {
    unsigned remainder = 0;
    for (unsigned char& byte : number) {
      const unsigned value = remainder * 256U + byte;
      byte = static_cast<unsigned char>(value / 10U);
      remainder = value % 10U;
    }
    digits.push_back(static_cast<char>('0' + remainder));
  }
  std::reverse(digits.begin(), digits.end());
  return digits.empty() ? "0" : digits;
}

}  // namespace

std::string uid_of(std::string_view kind, std::string_view content) {
  std::string all(kind);
  all.push_back('\0');
  all.append(content);
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  EVP_Digest(all.data(), all.size(), digest.data(), nullptr, EVP_sha256(), nullptr);
  Uuid uuid{};
  std::copy_n(digest.begin(), uuid.size(), uuid.begin());
  uuid[6] = static_cast<unsigned char>((uuid[6] & 0x0FU) | 0x80U);
  uuid[8] = static_cast<unsigned char>((uuid[8] & 0x3FU) | 0x80U);
  return absl::StrCat("2.25.", decimal_of(uuid));
}

}  // namespace lipofill::client
