#include "server/store/owned_files.h"

#include <vector>

#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace fs = std::filesystem;

absl::StatusOr<OwnedFiles> OwnedFiles::open(const fs::path& root) {
  std::error_code error;
  fs::create_directories(root, error);
  if (error) return absl::FailedPreconditionError(absl::StrCat("cannot make ", root.string(), ": ", error.message()));
  return OwnedFiles(root);
}

void OwnedFiles::remove(const std::string& owner, const std::string& name) const {
  std::error_code ignored;
  fs::remove(file(owner, name), ignored);
  fs::remove(directory(owner), ignored);  // only when it is empty
}

void OwnedFiles::remove_owner(const std::string& owner) const {
  std::error_code ignored;
  fs::remove_all(directory(owner), ignored);
}

int OwnedFiles::sweep(const Known& known) const {
  std::vector<std::string> owners;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(root_, error)) {
    if (entry.is_directory()) owners.push_back(entry.path().filename().string());
  }
  int removed = 0;
  for (const std::string& owner : owners) removed += sweep_owner(owner, known);
  return removed;
}

int OwnedFiles::sweep_owner(const std::string& owner, const Known& known) const {
  std::vector<std::string> unknown;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory(owner), error)) {
    const std::string name = entry.path().filename().string();
    if (!known(owner, name)) unknown.push_back(name);
  }
  for (const std::string& name : unknown) remove(owner, name);
  std::error_code ignored;
  fs::remove(directory(owner), ignored);  // only when it is empty
  return static_cast<int>(unknown.size());
}

}  // namespace lipofill::server
