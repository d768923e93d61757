#include "client/cpp/volume/tar_reader.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

constexpr uint64_t kBlock = 512;

/// Reads an octal number, as tar writes sizes; none for anything else.
std::optional<uint64_t> parse_octal(const char* text, size_t size) {
  uint64_t value = 0;
  size_t i = 0;
  while (i < size && text[i] == ' ') ++i;
  for (; i < size && text[i] >= '0' && text[i] <= '7'; ++i) value = 8 * value + static_cast<uint64_t>(text[i] - '0');
  if (i < size && text[i] != '\0' && text[i] != ' ') return std::nullopt;
  return value;
}

std::string text_of(const char* text, size_t size) {
  return std::string(text, strnlen(text, size));
}

/// The header's own sum of its bytes, the sum's field counted as spaces.
bool has_right_checksum(const std::array<char, kBlock>& header) {
  uint64_t sum = 0;
  for (size_t i = 0; i < header.size(); ++i) sum += i >= 148 && i < 156 ? ' ' : static_cast<unsigned char>(header[i]);
  return parse_octal(header.data() + 148, 8) == sum;
}

}  // namespace

void TarReader::Close::operator()(gzFile_s* stream) const {
  gzclose(stream);
}

absl::StatusOr<TarReader> TarReader::open(const std::filesystem::path& file) {
  TarReader reader;
  reader.file_ = file.string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return absl::InvalidArgumentError(absl::StrCat(file.string(), " does not exist or is not a file"));
  }
  reader.stream_.reset(gzopen(file.c_str(), "rb"));
  if (!reader.stream_) return absl::InvalidArgumentError(absl::StrCat("cannot read ", file.string()));
  return reader;
}

absl::Status TarReader::read(char* data, size_t size) {
  constexpr size_t kMostAtOnce = size_t{1} << 30;
  while (size > 0) {
    const int count = gzread(stream_.get(), data, static_cast<unsigned>(std::min(size, kMostAtOnce)));
    if (count <= 0) return absl::InvalidArgumentError(absl::StrCat(file_, " is cut short or not a gzipped tar"));
    data += count;
    size -= static_cast<size_t>(count);
    position_ += static_cast<uint64_t>(count);
  }
  return absl::OkStatus();
}

absl::StatusOr<TarEntry> TarReader::find(const std::string& suffix) {
  std::array<char, kBlock> block;
  while (true) {
    while (position_ < next_) {
      if (auto status = read(block.data(), std::min(kBlock, next_ - position_)); !status.ok()) return status;
    }
    if (auto status = read(block.data(), kBlock); !status.ok()) return status;
    if (std::all_of(block.begin(), block.end(), [](char c) { return c == '\0'; })) {
      return absl::NotFoundError(absl::StrCat(file_, " holds no ", suffix));
    }
    const auto size = parse_octal(block.data() + 124, 12);
    if (!has_right_checksum(block) || !size) return absl::InvalidArgumentError(absl::StrCat(file_, " is not a tar"));
    next_ = position_ + (*size + kBlock - 1) / kBlock * kBlock;
    TarEntry entry{text_of(block.data(), 100), *size};
    if (entry.name.ends_with(suffix)) return entry;
  }
}

}  // namespace lipofill::client
