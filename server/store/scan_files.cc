#include "server/store/scan_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/store/durable_file.h"

namespace lipofill::server {
namespace fs = std::filesystem;

absl::StatusOr<ScanFiles> ScanFiles::open(const fs::path& root) {
  std::error_code error;
  fs::create_directories(root, error);
  if (error) return absl::FailedPreconditionError(absl::StrCat("cannot make ", root.string(), ": ", error.message()));
  return ScanFiles(root);
}

uint64_t ScanFiles::size(const std::string& patient, const std::string& scan) const {
  std::error_code error;
  const auto bytes = fs::file_size(root_ / patient / scan, error);
  return error ? 0 : bytes;
}

absl::Status ScanFiles::write(const std::string& patient, const std::string& scan, uint64_t offset,
                              std::string_view bytes) const {
  std::error_code error;
  fs::create_directories(root_ / patient, error);
  const fs::path path = root_ / patient / scan;
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
  absl::Status done = flush_to_medium(root_ / patient / scan);
  done.Update(flush_to_medium(root_ / patient));
  done.Update(flush_to_medium(root_));
  return done;
}

absl::StatusOr<std::string> ScanFiles::read(const std::string& patient, const std::string& scan) const {
  std::ifstream file(root_ / patient / scan, std::ios::binary);
  std::string bytes(size(patient, scan), '\0');
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    return absl::DataLossError(absl::StrCat("the bytes of patients/", patient, "/scans/", scan, " cannot be read"));
  }
  return bytes;
}

void ScanFiles::remove(const std::string& patient, const std::string& scan) const {
  std::error_code ignored;
  fs::remove(root_ / patient / scan, ignored);
  fs::remove(root_ / patient, ignored);  // only when it is empty
}

void ScanFiles::remove_patient(const std::string& patient) const {
  std::error_code ignored;
  fs::remove_all(root_ / patient, ignored);
}

int ScanFiles::sweep(const std::function<bool(const std::string&, const std::string&)>& known) const {
  std::vector<std::pair<std::string, std::string>> unknown;
  std::error_code error;
  for (const auto& patient : fs::directory_iterator(root_, error)) {
    if (!patient.is_directory()) continue;
    for (const auto& scan : fs::directory_iterator(patient.path(), error)) {
      const std::string owner = patient.path().filename().string();
      const std::string name = scan.path().filename().string();
      if (!known(owner, name)) unknown.emplace_back(owner, name);
    }
  }
  for (const auto& [patient, scan] : unknown) remove(patient, scan);
  return static_cast<int>(unknown.size());
}

}  // namespace lipofill::server
