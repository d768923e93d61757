#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::server {

/// The file of SQLite has this name in a data directory, and in a backup of one.
inline constexpr char kDatabaseFile[] = "lipofill.sqlite";

/// The daemon's directory, locked for as long as this lives, so that two daemons never share one
/// store in a file of SQLite. Daemons that share a database share its directory too, each under a
/// name that no other has.
/// Checked by tests/unit/server/store/ownership_test.cc and
/// tests/integration/service/fleet_test.cc.
class DataDirectory {
 public:
  /// One of the daemons that share a directory. Its file there says, as does the database, which
  /// start of it this is, and how often it has renewed its lease: in a copy of the directory, or in
  /// another one, that is not so.
  struct Member {
    struct Beat {
      int64_t number = 0;  ///< of its start; 0: there is no such file
      int64_t beats = 0;
    };

    std::filesystem::path file;

    absl::Status make(int64_t number) const;
    /// FAILED_PRECONDITION where the file has gone.
    absl::Status write(const Beat& beat) const;
    Beat read() const;
  };

  /// Makes it (readable by its owner alone). FAILED_PRECONDITION when it cannot, or another daemon
  /// holds it.
  static absl::StatusOr<DataDirectory> open(const std::filesystem::path& path);
  /// The same for a daemon of this name (is_daemon_name()) that shares it with others.
  static absl::StatusOr<DataDirectory> open_shared(const std::filesystem::path& path, const std::string& name);
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
  /// A daemon that shares the directory, by its name.
  Member member(const std::string& name) const { return {path_ / "daemons" / name}; }
  /// The name under which it was opened; empty where it is not shared.
  const std::string& name() const { return name_; }

 private:
  DataDirectory(std::filesystem::path path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::filesystem::path path_;
  int lock_;
  std::string name_;
  int name_lock_ = -1;
};

/// Letters, digits, '.', '_', ':' and '-', one to 64 of them, the first a letter or a digit.
bool is_daemon_name(const std::string& text);

}  // namespace lipofill::server
