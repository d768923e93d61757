#include "server/store/checkpoint_files.h"

#include "absl/strings/str_cat.h"
#include "server/store/durable_file.h"

namespace lipofill::server {
namespace fs = std::filesystem;

absl::StatusOr<CheckpointFiles> CheckpointFiles::open(const fs::path& root) {
  auto files = OwnedFiles::open(root);
  if (!files.ok()) return files.status();
  return CheckpointFiles(*std::move(files));
}

absl::StatusOr<CheckpointFiles::Written> CheckpointFiles::write(const std::string& simulation,
                                                                const std::string& checkpoint,
                                                                const CheckpointContent& content) const {
  const std::string bytes = encode_checkpoint(content);
  if (bytes.size() > kMaxCheckpointBytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("a checkpoint of ", bytes.size(), " bytes, the bound is ", kMaxCheckpointBytes));
  }
  if (auto written = write_durably(files_.file(simulation, checkpoint), bytes); !written.ok()) return written;
  return Written{bytes.size(), sha256_of_checkpoint(bytes)};
}

absl::StatusOr<CheckpointContent> CheckpointFiles::read(const std::string& simulation, const std::string& checkpoint,
                                                        const std::string& sha256) const {
  const auto bytes = read_whole_file(files_.file(simulation, checkpoint), kMaxCheckpointBytes);
  if (!bytes.ok()) return bytes.status();
  auto content = decode_checkpoint(*bytes);
  if (!content.ok()) return content.status();
  if (sha256_of_checkpoint(*bytes) != sha256 || content->simulation != simulation) {
    return absl::DataLossError("it is another checkpoint than the one that was kept under this name");
  }
  return content;
}

}  // namespace lipofill::server
