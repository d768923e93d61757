#include "server/store/checkpoint_files.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "server/store/durable_file.h"

namespace lipofill::server {
namespace fs = std::filesystem;

absl::StatusOr<CheckpointFiles> CheckpointFiles::open(const fs::path& root) {
  std::error_code error;
  fs::create_directories(root, error);
  if (error) return absl::FailedPreconditionError(absl::StrCat("cannot make ", root.string(), ": ", error.message()));
  return CheckpointFiles(root);
}

absl::StatusOr<CheckpointFiles::Written> CheckpointFiles::write(const std::string& simulation,
                                                                const std::string& checkpoint,
                                                                const CheckpointContent& content) const {
  const std::string bytes = encode_checkpoint(content);
  if (bytes.size() > kMaxCheckpointBytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("a checkpoint of ", bytes.size(), " bytes, the bound is ", kMaxCheckpointBytes));
  }
  if (auto written = write_durably(root_ / simulation / checkpoint, bytes); !written.ok()) return written;
  return Written{bytes.size(), sha256_of_checkpoint(bytes)};
}

absl::StatusOr<CheckpointContent> CheckpointFiles::read(const std::string& simulation, const std::string& checkpoint,
                                                        const std::string& sha256) const {
  const auto bytes = read_whole_file(root_ / simulation / checkpoint, kMaxCheckpointBytes);
  if (!bytes.ok()) return bytes.status();
  auto content = decode_checkpoint(*bytes);
  if (!content.ok()) return content.status();
  if (sha256_of_checkpoint(*bytes) != sha256 || content->simulation != simulation) {
    return absl::DataLossError("it is another checkpoint than the one that was kept under this name");
  }
  return content;
}

void CheckpointFiles::remove(const std::string& simulation, const std::string& checkpoint) const {
  std::error_code ignored;
  fs::remove(root_ / simulation / checkpoint, ignored);
  fs::remove(root_ / simulation, ignored);  // only when it is empty
}

void CheckpointFiles::remove_simulation(const std::string& simulation) const {
  std::error_code ignored;
  fs::remove_all(root_ / simulation, ignored);
}

int CheckpointFiles::sweep(const Known& known) const {
  std::vector<std::string> simulations;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(root_, error)) {
    if (entry.is_directory()) simulations.push_back(entry.path().filename().string());
  }
  int removed = 0;
  for (const std::string& simulation : simulations) removed += sweep_simulation(simulation, known);
  return removed;
}

int CheckpointFiles::sweep_simulation(const std::string& simulation, const Known& known) const {
  std::vector<std::string> unknown;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(root_ / simulation, error)) {
    const std::string name = entry.path().filename().string();
    if (!known(simulation, name)) unknown.push_back(name);
  }
  for (const std::string& name : unknown) remove(simulation, name);
  std::error_code ignored;
  fs::remove(root_ / simulation, ignored);  // only when it is empty
  return static_cast<int>(unknown.size());
}

}  // namespace lipofill::server
