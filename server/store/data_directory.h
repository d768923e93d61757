#pragma once

#include <filesystem>

#include "absl/status/statusor.h"

namespace lipofill::server {

/// The file of SQLite has this name in a data directory, and in a backup of one.
inline constexpr char kDatabaseFile[] = "lipofill.sqlite";

/// The daemon's directory, locked for as long as this lives, so that two daemons never share one
/// store.
class DataDirectory {
 public:
  /// Makes it (readable by its owner alone). FAILED_PRECONDITION when it cannot, or another daemon
  /// holds it.
  static absl::StatusOr<DataDirectory> open(const std::filesystem::path& path);
  DataDirectory(DataDirectory&& other) noexcept;
  DataDirectory& operator=(DataDirectory&&) = delete;
  ~DataDirectory();

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path database() const { return path_ / kDatabaseFile; }
  /// Holds room on the medium, see SpaceReserve.
  std::filesystem::path reserve() const { return path_ / "reserve"; }
  /// Says which store the directory belongs to.
  std::filesystem::path identity() const { return path_ / "store-id"; }
  std::filesystem::path scans() const { return path_ / "scans"; }
  std::filesystem::path checkpoints() const { return path_ / "checkpoints"; }

 private:
  DataDirectory(std::filesystem::path path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::filesystem::path path_;
  int lock_;
};

}  // namespace lipofill::server
