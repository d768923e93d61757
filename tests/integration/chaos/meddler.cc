#include "tests/integration/chaos/meddler.h"

#include <algorithm>
#include <fstream>

namespace lipofill::testing {
namespace fs = std::filesystem;

void Meddler::meddle() {
  const std::vector<fs::path> files = automatic_checkpoints();
  if (files.empty()) return;
  const fs::path& file = files[random_() % files.size()];
  switch (random_() % 3) {
    case 0:
      fs::remove(file);
      ++removed_;
      return;
    case 1:
      return replace(file);
    default:
      return flip_bit(file);
  }
}

/// In an order of its own, so that a seed chooses the same.
std::vector<fs::path> Meddler::automatic_checkpoints() const {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(data_ / "checkpoints", error)) {
    const std::string name = entry.path().filename().string();
    // Clients call theirs c1, c2, ..., a new simulation its first one origin.
    if (entry.is_regular_file() && name.front() == 'a' && entry.path().extension().empty()) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Another checkpoint of the same simulation, if there is one.
void Meddler::replace(const fs::path& file) {
  for (const auto& other : fs::directory_iterator(file.parent_path())) {
    if (other.path() == file || !other.path().extension().empty()) continue;
    fs::copy_file(other.path(), file, fs::copy_options::overwrite_existing);
    ++replaced_;
    return;
  }
}

void Meddler::flip_bit(const fs::path& file) {
  const auto size = fs::file_size(file);
  if (size == 0) return;
  std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
  const auto at = static_cast<std::streamoff>(random_() % size);
  bytes.seekg(at);
  const int byte = bytes.get();
  bytes.seekp(at);
  bytes.put(static_cast<char>(byte ^ (1 << (random_() % 8))));
  ++flipped_;
}

}  // namespace lipofill::testing
