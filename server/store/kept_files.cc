#include "server/store/kept_files.h"

#include <array>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "core/base/hash.h"
#include "server/store/checkpoint_files.h"
#include "server/store/durable_file.h"
#include "server/store/record_names.h"
#include "server/store/temporary_files.h"

namespace lipofill::server {
namespace fs = std::filesystem;
namespace {

absl::Status add_scans(Database& database, std::vector<KeptFile>& files) {
  Query query(database, "SELECT patient, id, complete, sha256 FROM scans ORDER BY patient, id");
  while (query.next()) {
    const std::string patient = query.text(0), id = query.text(1);
    files.push_back({scan_path(patient, id), scan_name(patient, id), true, query.is_true(2), "", query.text(3)});
  }
  return query.status();
}

absl::Status add_checkpoints(Database& database, std::vector<KeptFile>& files) {
  Query query(database, "SELECT simulation, id, sha256 FROM checkpoints ORDER BY simulation, id");
  while (query.next()) {
    const std::string simulation = query.text(0), id = query.text(1);
    files.push_back(
        {checkpoint_path(simulation, id), checkpoint_name(simulation, id), false, true, simulation, query.text(2)});
  }
  return query.status();
}

absl::Status missing(const fs::path& path) {
  return absl::DataLossError(absl::StrCat("its file ", path.string(), " is missing"));
}

/// Scans are hashed a piece at a time: they may be large.
absl::StatusOr<uint64_t> check_scan(const fs::path& path, const KeptFile& file) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return missing(path);
  std::array<char, 1 << 16> chunk{};
  Hasher hasher;
  uint64_t size = 0;
  while (in.read(chunk.data(), chunk.size()) || in.gcount() > 0) {
    hasher.add_bytes(chunk.data(), static_cast<size_t>(in.gcount()));
    size += static_cast<uint64_t>(in.gcount());
  }
  if (hasher.hex_digest() == file.sha256) return size;
  return absl::DataLossError(absl::StrCat("its file ", path.string(), " is not what was uploaded: the SHA-256 of ",
                                          size, " bytes is another"));
}

absl::StatusOr<uint64_t> check_checkpoint(const fs::path& path, const KeptFile& file) {
  const auto bytes = read_whole_file(path, kMaxCheckpointBytes);
  if (absl::IsNotFound(bytes.status())) return missing(path);
  if (!bytes.ok()) return bytes.status();
  const auto content = decode_checkpoint(*bytes);
  if (!content.ok()) {
    return absl::DataLossError(absl::StrCat("its file ", path.string(), ": ", std::string(content.status().message())));
  }
  if (sha256_of_checkpoint(*bytes) == file.sha256 && content->simulation == file.simulation) return bytes->size();
  return absl::DataLossError(absl::StrCat("its file ", path.string(), " is that of another checkpoint"));
}

}  // namespace

absl::StatusOr<std::vector<KeptFile>> list_kept_files(Database& database) {
  std::vector<KeptFile> files;
  absl::Status listed = add_scans(database, files);
  listed.Update(add_checkpoints(database, files));
  if (!listed.ok()) return listed;
  return files;
}

absl::StatusOr<uint64_t> check_kept_file(const fs::path& root, const KeptFile& file) {
  const fs::path path = root / file.path;
  if (!file.is_scan) return check_checkpoint(path, file);
  if (file.is_whole) return check_scan(path, file);
  std::error_code error;
  const auto size = fs::file_size(path, error);
  return error ? 0 : size;
}

}  // namespace lipofill::server
