#include "server/store/stray_files.h"

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "server/store/durable_file.h"

namespace lipofill::server {
namespace fs = std::filesystem;
namespace {

absl::Status move(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (!error) fs::rename(from, to, error);
  if (error) return file_error(absl::StrCat("cannot set ", from.string(), " aside"), error.value());
  fs::remove(from.parent_path(), error);  // only when it is empty
  return absl::OkStatus();
}

absl::Status move_all(const OwnedFiles& files, const OwnedFiles::Known& known, Strays& strays) {
  for (const fs::path& path : files.list_unknown(known)) {
    const fs::path place = strays.place / files.root().filename() / path;
    if (absl::Status moved = move(files.root() / path, place); !moved.ok()) return moved;
    ++strays.files;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Strays> set_strays_aside(Store& store, const ScanFiles& scans, const CheckpointFiles& checkpoints,
                                        const fs::path& data, int64_t now_us) {
  Strays strays;
  strays.place =
      data / "set-aside" / absl::FormatTime("%Y%m%dT%H%M%E6SZ", absl::FromUnixMicros(now_us), absl::UTCTimeZone());
  absl::Status moved = move_all(
      scans.files(),
      [&store](const std::string& patient, const std::string& scan) {
        return !absl::IsNotFound(store.get_scan(patient, scan).status());
      },
      strays);
  if (!moved.ok()) return moved;
  moved = move_all(
      checkpoints.files(),
      [&store](const std::string& simulation, const std::string& checkpoint) {
        return !absl::IsNotFound(store.get_checkpoint(simulation, checkpoint).status());
      },
      strays);
  if (!moved.ok()) return moved;
  return strays;
}

}  // namespace lipofill::server
