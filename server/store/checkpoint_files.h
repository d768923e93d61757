#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/owned_files.h"

namespace lipofill::server {

/// Content of a checkpoint's file: everything that a simulation needs to go on, besides its model.
struct CheckpointContent {
  std::string simulation;    ///< id
  uint64_t step = 0;         ///< the state is after this step
  std::string spec_message;  ///< the plan with the injections taken by then
  std::string snapshot;      ///< simulation::Simulation::snapshot()
};

/// Largest size of a file that is written or read.
inline constexpr uint64_t kMaxCheckpointBytes = uint64_t{1} << 30;

/// A checkpoint as the bytes of its file, little-endian:
///
///     "LIPOCKPT"  u32 version = 1  u32 0  u64 size of the body  SHA-256 of the body, 32 bytes
///     body: u64 step, then simulation, spec_message and snapshot, each a u64 length and its bytes
std::string encode_checkpoint(const CheckpointContent& content);
/// Decodes a checkpoint. DATA_LOSS saying what does not fit; no length is believed beyond the bytes
/// that are there. Checked by tests/unit/server/store/checkpoint_files_test.cc with every bit
/// flipped and every length cut.
absl::StatusOr<CheckpointContent> decode_checkpoint(std::string_view bytes);

/// The SHA-256 that the file's header says its body has, in hex; empty when there is no header.
std::string sha256_of_checkpoint(std::string_view bytes);

/// The files of checkpoints: <root>/<simulation>/<checkpoint>. Ids are checked by whoever calls:
/// they hold no separators. Checked by tests/unit/server/store/checkpoint_files_test.cc.
class CheckpointFiles {
 public:
  static absl::StatusOr<CheckpointFiles> open(const std::filesystem::path& root);

  struct Written {
    uint64_t size_bytes = 0;
    std::string sha256;  ///< is computed from the file's body
  };
  /// Writes the file whole and on the medium, or not at all. RESOURCE_EXHAUSTED when there is no
  /// room or it is too large.
  absl::StatusOr<Written> write(const std::string& simulation, const std::string& checkpoint,
                                const CheckpointContent& content) const;
  /// Reads a checkpoint. DATA_LOSS unless the file is the one that was written: its hash, its
  /// simulation.
  absl::StatusOr<CheckpointContent> read(const std::string& simulation, const std::string& checkpoint,
                                         const std::string& sha256) const;
  void remove(const std::string& simulation, const std::string& checkpoint) const {
    files_.remove(simulation, checkpoint);
  }
  const OwnedFiles& files() const { return files_; }

 private:
  explicit CheckpointFiles(OwnedFiles files) : files_(std::move(files)) {}
  OwnedFiles files_;
};

}  // namespace lipofill::server
