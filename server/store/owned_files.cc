#include "server/store/owned_files.h"

#include <algorithm>
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

std::vector<fs::path> OwnedFiles::list_unknown(const Known& known) const {
  std::vector<fs::path> unknown;
  std::error_code error;
  for (const auto& owner : fs::directory_iterator(root_, error)) {
    if (!owner.is_directory(error)) {
      unknown.push_back(owner.path().filename());
      continue;
    }
    for (const auto& file : fs::directory_iterator(owner.path(), error)) {
      if (known(owner.path().filename(), file.path().filename())) continue;
      unknown.push_back(owner.path().filename() / file.path().filename());
    }
  }
  std::sort(unknown.begin(), unknown.end());
  return unknown;
}

}  // namespace lipofill::server
