#include "client/cpp/volume/unpacking.h"

#include <archive.h>
#include <archive_entry.h>
#include <fcntl.h>
#include <unistd.h>
#include <vtkSetGet.h>
#include <vtkType.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

constexpr size_t kPackedPiece = size_t{1} << 16;
constexpr size_t kUnpackedPiece = size_t{1} << 18;
/// Longer words are no numbers.
constexpr size_t kMaxWord = 64;

/// A zlib stream that ends with the scope.
struct Inflater {
  z_stream state{};
  bool usable = false;
  Inflater() {
    constexpr int kDetectFormat = 15 + 32;
    usable = inflateInit2(&state, kDetectFormat) == Z_OK;
  }
  ~Inflater() {
    if (usable) inflateEnd(&state);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
};

/// A file opened at an offset, closed with the scope.
struct Descriptor {
  int number = -1;
  Descriptor(const std::filesystem::path& file, uint64_t offset) : number(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (number >= 0) (void)::lseek(number, static_cast<off_t>(offset), SEEK_SET);
  }
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

/// Calls `take` with the characters of a file; false: enough.
template <typename Take>
void for_each_byte(const std::filesystem::path& file, uint64_t offset, const Take& take) {
  (void)copy_bytes(file, offset, [&](const unsigned char* piece, size_t size) {
    for (size_t k = 0; k < size; ++k) {
      if (!take(static_cast<char>(piece[k]))) return false;
    }
    return true;
  });
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char lower = absl::ascii_tolower(static_cast<unsigned char>(c));
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

/// Whole numbers are read as such, for a double cannot hold all of 64 bits.
template <typename T>
bool parse_value(const std::string& word, T* value) {
  if constexpr (std::is_integral_v<T>) {
    using Wide = std::conditional_t<std::is_signed_v<T>, int64_t, uint64_t>;
    Wide wide = 0;
    if (absl::SimpleAtoi(word, &wide)) {
      *value = static_cast<T>(wide);
      return static_cast<Wide>(*value) == wide;
    }
  }
  double number = 0.0;
  if (!absl::SimpleAtod(word, &number)) return false;
  if constexpr (std::is_integral_v<T>) {
    // 2^digits is the first value beyond the type, and a double holds it exactly.
    const double beyond = std::ldexp(1.0, std::numeric_limits<T>::digits);
    if (number != std::floor(number) || number >= beyond || number < (std::is_signed_v<T> ? -beyond : 0.0))
      return false;
  }
  *value = static_cast<T>(number);
  return true;
}

template <typename T>
absl::Status unpack_numbers(const std::filesystem::path& file, uint64_t offset, const TakeBytes& take) {
  std::string word;
  std::string wrong;
  bool wants_more = true;
  const auto finish_word = [&] {
    T value{};
    if (word.empty()) return true;
    if (!parse_value(word, &value)) {
      wrong = word;
      return false;
    }
    word.clear();
    wants_more = take(reinterpret_cast<const unsigned char*>(&value), sizeof value);
    return wants_more;
  };
  for_each_byte(file, offset, [&](char c) {
    if (absl::ascii_isspace(static_cast<unsigned char>(c)) || c == ',') return finish_word();
    word += absl::ascii_isprint(static_cast<unsigned char>(c)) ? c : '?';
    if (word.size() <= kMaxWord) return true;
    wrong = word;
    return false;
  });
  if (wrong.empty() && wants_more) finish_word();
  if (wrong.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("has \"", wrong, "\" where its type asks for a number"));
}

}  // namespace

absl::Status copy_bytes(const std::filesystem::path& file, uint64_t offset, const TakeBytes& take) {
  std::ifstream input(file, std::ios::binary);
  input.seekg(static_cast<std::streamoff>(offset));
  std::vector<unsigned char> piece(kUnpackedPiece);
  while (input) {
    input.read(reinterpret_cast<char*>(piece.data()), static_cast<std::streamsize>(piece.size()));
    const auto count = static_cast<size_t>(input.gcount());
    if (count == 0 || !take(piece.data(), count)) break;
  }
  return absl::OkStatus();
}

absl::Status unpack_zlib(const std::filesystem::path& file, uint64_t offset, const TakeBytes& take) {
  std::ifstream input(file, std::ios::binary);
  input.seekg(static_cast<std::streamoff>(offset));
  Inflater inflater;
  z_stream& stream = inflater.state;
  if (!input || !inflater.usable) return absl::InvalidArgumentError("cannot be read");
  std::vector<unsigned char> packed(kPackedPiece), unpacked(kUnpackedPiece);
  const auto refill = [&] {
    input.read(reinterpret_cast<char*>(packed.data()), static_cast<std::streamsize>(packed.size()));
    stream.next_in = packed.data();
    stream.avail_in = static_cast<uInt>(input.gcount());
    return stream.avail_in > 0;
  };
  bool has_member = false;
  uint64_t in_member = 0;
  while (stream.avail_in > 0 || refill()) {
    stream.next_out = unpacked.data();
    stream.avail_out = static_cast<uInt>(unpacked.size());
    const int result = inflate(&stream, Z_NO_FLUSH);
    const size_t count = unpacked.size() - stream.avail_out;
    if (count > 0 && !take(unpacked.data(), count)) return absl::OkStatus();
    in_member += count;
    if (result == Z_STREAM_END) {
      has_member = true;
      in_member = 0;
      if (inflateReset(&stream) != Z_OK) break;
    } else if (result != Z_OK && result != Z_BUF_ERROR) {
      // Padding after a whole member is none of ours.
      if (has_member && in_member == 0) break;
      return absl::InvalidArgumentError(in_member > 0
                                            ? "is damaged: its compressed voxels do not have the sum they should"
                                            : "is damaged: its voxels are not gzip or zlib, as its header says");
    }
  }
  return absl::OkStatus();
}

absl::Status unpack_bzip2(const std::filesystem::path& file, uint64_t offset, const TakeBytes& take) {
  const Descriptor input(file, offset);
  const std::unique_ptr<archive, decltype(&archive_read_free)> stream(archive_read_new(), &archive_read_free);
  if (input.number < 0 || !stream) return absl::InvalidArgumentError("cannot be read");
  archive_read_support_filter_bzip2(stream.get());
  archive_read_support_format_raw(stream.get());
  archive_entry* entry = nullptr;
  if (archive_read_open_fd(stream.get(), input.number, kPackedPiece) != ARCHIVE_OK ||
      archive_read_next_header(stream.get(), &entry) != ARCHIVE_OK ||
      archive_filter_code(stream.get(), 0) != ARCHIVE_FILTER_BZIP2) {
    return absl::InvalidArgumentError("is damaged: its voxels are not bzip2, as its header says");
  }
  std::vector<unsigned char> unpacked(kUnpackedPiece);
  while (true) {
    const la_ssize_t count = archive_read_data(stream.get(), unpacked.data(), unpacked.size());
    if (count < 0) return absl::InvalidArgumentError("is damaged or cut short in its bzip2 voxels");
    if (count == 0 || !take(unpacked.data(), static_cast<size_t>(count))) return absl::OkStatus();
  }
}

absl::Status unpack_hex(const std::filesystem::path& file, uint64_t offset, const TakeBytes& take) {
  int high = -1;
  bool wrong = false;
  std::vector<unsigned char> piece;
  bool wants_more = true;
  for_each_byte(file, offset, [&](char c) {
    if (absl::ascii_isspace(static_cast<unsigned char>(c))) return true;
    const int digit = hex_digit(c);
    if ((wrong = digit < 0)) return false;
    if (high < 0) {
      high = digit;
      return true;
    }
    piece.push_back(static_cast<unsigned char>(16 * high + digit));
    high = -1;
    if (piece.size() < kUnpackedPiece) return true;
    wants_more = take(piece.data(), piece.size());
    piece.clear();
    return wants_more;
  });
  if (wrong) return absl::InvalidArgumentError("has a character among its voxels that is no hexadecimal digit");
  if (wants_more && !piece.empty()) take(piece.data(), piece.size());
  return absl::OkStatus();
}

absl::Status unpack_text(const std::filesystem::path& file, uint64_t offset, int vtk_type, const TakeBytes& take) {
  switch (vtk_type) { vtkTemplateMacro(return unpack_numbers<VTK_TT>(file, offset, take)); }
  return absl::InternalError(absl::StrCat("no VTK type ", vtk_type));
}

}  // namespace lipofill::client
