#include "client/cpp/volume/header_text.h"

#include <array>
#include <cmath>
#include <fstream>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace lipofill::client {
namespace {

constexpr uint64_t kMaxHeaderBytes = 64 << 10;
constexpr double kMaxVoxelsAlong = 65535;

}  // namespace

std::string HeaderText::value(const std::string& key) const {
  const auto found = values.find(key);
  return found == values.end() ? std::string() : found->second;
}

absl::StatusOr<HeaderText> read_header_text(const std::filesystem::path& file, char separator,
                                            const std::string& last_key) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return bad_volume(file, "cannot be read");
  std::string head(kMaxHeaderBytes, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(stream.gcount()));
  HeaderText text;
  for (size_t begin = 0; begin < head.size();) {
    const size_t end = head.find('\n', begin);
    // A detached header may end without a line end.
    const std::string line = head.substr(begin, end == std::string::npos ? end : end - begin);
    if (line.find('\0') != std::string::npos) return bad_volume(file, "has a byte of 0 in its header, which is text");
    const std::string stripped(absl::StripAsciiWhitespace(line));
    if (begin == 0) text.first_line = stripped;
    begin = end == std::string::npos ? head.size() : end + 1;
    text.end = begin;
    if (stripped.empty()) return text;
    const size_t middle = stripped.find(separator);
    if (middle == std::string::npos || stripped[0] == '#') continue;
    const std::string key = absl::AsciiStrToLower(std::string(absl::StripAsciiWhitespace(stripped.substr(0, middle))));
    text.values[key] = std::string(absl::StripAsciiWhitespace(stripped.substr(middle + 1)));
    if (key == last_key) return text;
  }
  if (head.size() == kMaxHeaderBytes)
    return bad_volume(file, absl::StrCat("has no end of its header in the first ", kMaxHeaderBytes, " bytes"));
  return text;
}

std::optional<std::vector<double>> parse_numbers(const std::string& text) {
  std::vector<double> numbers;
  for (const auto& word : absl::StrSplit(text, absl::ByAnyChar(" \t,()"), absl::SkipEmpty())) {
    double number = 0.0;
    if (!absl::SimpleAtod(word, &number) || !std::isfinite(number)) return std::nullopt;
    numbers.push_back(number);
  }
  return numbers;
}

absl::StatusOr<std::array<uint64_t, 3>> parse_sizes(const std::filesystem::path& file, const std::string& key,
                                                    const std::string& text) {
  const auto numbers = parse_numbers(text);
  if (!numbers || numbers->size() != 3)
    return bad_volume(file, absl::StrCat("has ", key, " \"", text, "\", which is not three sizes"));
  std::array<uint64_t, 3> sizes{};
  for (size_t i = 0; i < 3; ++i) {
    const double size = (*numbers)[i];
    if (size < 2 || size > kMaxVoxelsAlong || size != std::floor(size)) {
      return bad_volume(file, absl::StrCat("has ", key, " ", size, ", not in [2, ", kMaxVoxelsAlong, "]"));
    }
    sizes[i] = static_cast<uint64_t>(size);
  }
  return sizes;
}

absl::Status bad_volume(const std::filesystem::path& file, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("volume ", file.string(), " ", what));
}

}  // namespace lipofill::client
