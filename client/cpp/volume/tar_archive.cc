#include "client/cpp/volume/tar_archive.h"

#include <archive.h>
#include <archive_entry.h>

#include <string_view>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

constexpr size_t kReadAtOnce = size_t{1} << 16;

/// The name of an entry; empty where it has none that can be told.
std::string_view name_of(archive_entry* entry) {
  const char* name = archive_entry_pathname_utf8(entry);
  if (name == nullptr) name = archive_entry_pathname(entry);
  return name != nullptr ? name : "";
}

/// libarchive goes on after a warning, such as a name that the locale cannot write.
bool is_usable(int result) {
  return result == ARCHIVE_OK || result == ARCHIVE_WARN;
}

}  // namespace

void TarArchive::Close::operator()(archive* stream) const {
  archive_read_free(stream);
}

absl::StatusOr<TarArchive> TarArchive::open(const std::filesystem::path& file) {
  TarArchive tar;
  tar.file_ = file.string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return absl::InvalidArgumentError(absl::StrCat(tar.file_, " does not exist or is not a file"));
  }
  tar.stream_.reset(archive_read_new());
  archive* const stream = tar.stream_.get();
  if (stream == nullptr) return absl::ResourceExhaustedError(absl::StrCat("no memory to read ", tar.file_));
  archive_read_support_filter_gzip(stream);
  archive_read_support_format_tar(stream);
  if (!is_usable(archive_read_open_filename(stream, file.c_str(), kReadAtOnce)))
    return tar.explain("is not a tar, gzipped or not");
  return tar;
}

absl::StatusOr<uint64_t> TarArchive::find(const std::string& suffix) {
  while (true) {
    archive_entry* entry = nullptr;
    const int result = archive_read_next_header(stream_.get(), &entry);
    if (result == ARCHIVE_EOF) return absl::NotFoundError(absl::StrCat(file_, " holds no ", suffix));
    if (!is_usable(result)) return explain("is not a tar, gzipped or not");
    const int64_t size = archive_entry_size(entry);
    if (size < 0 || static_cast<uint64_t>(size) > kMaxUnpackedBytes - claimed_bytes_) {
      return absl::InvalidArgumentError(
          absl::StrCat(file_, " claims to hold more than the ", kMaxUnpackedBytes, " bytes allowed in an archive"));
    }
    claimed_bytes_ += static_cast<uint64_t>(size);
    if (archive_entry_filetype(entry) == AE_IFREG && name_of(entry).ends_with(suffix)) {
      return static_cast<uint64_t>(size);
    }
  }
}

absl::Status TarArchive::read(char* data, size_t size) {
  while (size > 0) {
    const la_ssize_t count = archive_read_data(stream_.get(), data, size);
    if (count < 0) return explain("is damaged");
    if (count == 0) return absl::InvalidArgumentError(absl::StrCat(file_, " is cut short"));
    data += count;
    size -= static_cast<size_t>(count);
  }
  return absl::OkStatus();
}

/// Says in our words what libarchive found wrong with the file, where we know; its own words
/// follow.
absl::Status TarArchive::explain(const char* otherwise) const {
  const char* const text = archive_error_string(stream_.get());
  const std::string_view found = text != nullptr ? text : "";
  const bool is_short = found.find("runcated") != std::string_view::npos;
  return absl::InvalidArgumentError(
      absl::StrCat(file_, " ", is_short ? "is cut short" : otherwise, found.empty() ? "" : ": ", std::string(found)));
}

}  // namespace lipofill::client
