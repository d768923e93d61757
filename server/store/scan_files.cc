#include "server/store/scan_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "core/base/hash.h"
#include "server/store/durable_file.h"
#include "server/store/record_names.h"

namespace lipofill::server {
namespace fs = std::filesystem;
namespace {

/// Far above what is taken in: a file that grew so large is none of ours.
constexpr uint64_t kMaxScanBytes = uint64_t{1} << 30;

}  // namespace

absl::StatusOr<ScanFiles> ScanFiles::open(const fs::path& root) {
  auto files = OwnedFiles::open(root);
  if (!files.ok()) return files.status();
  return ScanFiles(*std::move(files));
}

uint64_t ScanFiles::size(const std::string& patient, const std::string& scan) const {
  std::error_code error;
  const auto bytes = fs::file_size(files_.file(patient, scan), error);
  return error ? 0 : bytes;
}

int64_t ScanFiles::last_write_us(const std::string& patient, const std::string& scan) const {
  struct stat about {};
  if (::stat(files_.file(patient, scan).c_str(), &about) != 0) return 0;
  return int64_t{about.st_mtim.tv_sec} * 1'000'000 + about.st_mtim.tv_nsec / 1'000;
}

absl::Status ScanFiles::write(const std::string& patient, const std::string& scan, uint64_t offset,
                              std::string_view bytes) const {
  std::error_code error;
  fs::create_directories(files_.directory(patient), error);
  const fs::path path = files_.file(patient, scan);
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) return absl::UnavailableError(absl::StrCat("cannot write a scan: ", std::strerror(errno)));
  absl::Status done;
  while (done.ok() && !bytes.empty()) {
    const ssize_t n = ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      done = absl::ResourceExhaustedError(absl::StrCat("cannot write a scan: ", std::strerror(errno)));
      break;
    }
    bytes.remove_prefix(static_cast<size_t>(n));
    offset += static_cast<uint64_t>(n);
  }
  ::close(file);
  return done;
}

absl::Status ScanFiles::flush(const std::string& patient, const std::string& scan) const {
  absl::Status done = flush_to_medium(files_.file(patient, scan));
  done.Update(flush_to_medium(files_.directory(patient)));
  done.Update(flush_to_medium(files_.root()));
  return done;
}

absl::StatusOr<std::string> ScanFiles::read(const std::string& patient, const std::string& scan) const {
  const std::string name = scan_name(patient, scan);
  const fs::path path = files_.file(patient, scan);
  auto bytes = read_whole_file(path, kMaxScanBytes);
  if (bytes.ok()) return bytes;
  if (absl::IsNotFound(bytes.status())) {
    return absl::DataLossError(
        absl::StrCat(name, " is damaged: its file ", path.string(), " is missing; put it back from a backup"));
  }
  return absl::Status(bytes.status().code(), absl::StrCat(name, ": ", std::string(bytes.status().message())));
}

absl::StatusOr<std::string> ScanFiles::read_whole(const std::string& patient, const std::string& scan,
                                                  const std::string& sha256) const {
  auto bytes = read(patient, scan);
  if (!bytes.ok()) return bytes;
  Hasher hasher;
  hasher.add_bytes(bytes->data(), bytes->size());
  if (hasher.hex_digest() == sha256) return bytes;
  return absl::DataLossError(absl::StrCat(scan_name(patient, scan), " is damaged: its file is not what was uploaded, ",
                                          "the SHA-256 of its ", bytes->size(),
                                          " bytes is another; put it back from a backup"));
}

}  // namespace lipofill::server
