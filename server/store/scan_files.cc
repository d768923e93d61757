#include "server/store/scan_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "server/store/durable_file.h"

namespace lipofill::server {
namespace fs = std::filesystem;

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
  std::ifstream file(files_.file(patient, scan), std::ios::binary);
  std::string bytes(size(patient, scan), '\0');
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    return absl::DataLossError(absl::StrCat("the bytes of patients/", patient, "/scans/", scan, " cannot be read"));
  }
  return bytes;
}

}  // namespace lipofill::server
