#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::server {

/// Files that belong to something, <root>/<owner>/<name>. An owner's directory goes with its last
/// file. Ids are checked by whoever calls: they hold no separators. Checked by
/// tests/unit/server/store/scan_files_test.cc and checkpoint_files_test.cc.
class OwnedFiles {
 public:
  static absl::StatusOr<OwnedFiles> open(const std::filesystem::path& root);

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path directory(const std::string& owner) const { return root_ / owner; }
  std::filesystem::path file(const std::string& owner, const std::string& name) const { return root_ / owner / name; }

  void remove(const std::string& owner, const std::string& name) const;

  using Known = std::function<bool(const std::string& owner, const std::string& name)>;
  /// The files that nobody knows, as paths from the root.
  std::vector<std::filesystem::path> list_unknown(const Known& known) const;

 private:
  explicit OwnedFiles(std::filesystem::path root) : root_(std::move(root)) {}
  std::filesystem::path root_;
};

}  // namespace lipofill::server
