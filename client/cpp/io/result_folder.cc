#include "client/cpp/io/result_folder.h"

#include <algorithm>
#include <regex>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "client/cpp/io/mesh_files.h"

namespace lipofill::client {
namespace {

/// True for names of our own making only: a folder may hold other things.
bool is_frame_file(const std::string& name) {
  static const std::regex pattern(R"((skin|scan|tissue|film(_.+)?)(_\d{4,}\.vt[pu]|_preview\.vtp|\.pvd))");
  return std::regex_match(name, pattern);
}

constexpr char kFilmPrefix[] = "film/";

bool is_film(const std::string& mesh) {
  return mesh.starts_with(kFilmPrefix);
}

}  // namespace

absl::Status ResultFolder::prepare() {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  if (error)
    return absl::InvalidArgumentError(absl::StrCat("cannot make the folder ", path_.string(), ": ", error.message()));
  std::vector<std::filesystem::path> old;
  for (const auto& entry : std::filesystem::directory_iterator(path_, error)) {
    if (is_frame_file(entry.path().filename().string())) old.push_back(entry.path());
  }
  for (const std::filesystem::path& file : old) std::filesystem::remove(file, error);
  if (error)
    return absl::InvalidArgumentError(absl::StrCat("cannot clear the folder ", path_.string(), ": ", error.message()));
  return absl::OkStatus();
}

std::string ResultFolder::stem_of(const std::string& mesh) const {
  if (!is_film(mesh)) return mesh;
  const auto is_points_of_film = [](const Array& array) {
    return array.field() == "points" && array.mesh().starts_with(kFilmPrefix);
  };
  if (std::count_if(meshes_.begin(), meshes_.end(), is_points_of_film) == 1) return "film";
  return absl::StrCat("film_", absl::StrReplaceAll(mesh.substr(sizeof kFilmPrefix - 1), {{"/", "_"}}));
}

absl::Status ResultFolder::write_frame(double time_s, const std::vector<Array>& fields) {
  if (last_time_s_ == time_s) return absl::OkStatus();
  const auto views = mesh_views(meshes_, fields);
  if (!views.ok()) return views.status();
  for (const MeshView& view : *views) {
    const std::string stem = stem_of(view.name);
    auto& collection = collections_[stem];
    const std::string name = absl::StrFormat("%s_%04d%s", stem, frames_, mesh_extension(view));
    if (auto status = write_mesh(path_ / name, view); !status.ok()) return status;
    collection.emplace_back(time_s, name);
    if (auto status = write_collection(path_ / (stem + ".pvd"), collection); !status.ok()) return status;
  }
  last_time_s_ = time_s;
  ++frames_;
  return absl::OkStatus();
}

absl::Status ResultFolder::write_preview(const std::vector<Array>& fields) const {
  const auto views = mesh_views(meshes_, fields);
  if (!views.ok()) return views.status();
  for (const MeshView& view : *views) {
    if (view.fields.empty()) continue;
    const std::string name = absl::StrCat(stem_of(view.name), "_preview", mesh_extension(view));
    if (auto status = write_mesh(path_ / name, view); !status.ok()) return status;
  }
  return absl::OkStatus();
}

std::filesystem::path last_frame_file(const std::filesystem::path& folder, const std::string& stem) {
  std::filesystem::path last;
  std::error_code error;
  const std::regex pattern(stem + R"(_(\d{4,})\.vt[pu])");
  long highest = -1;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    std::smatch match;
    if (!std::regex_match(name, match, pattern) || match[1].length() > 9) continue;
    if (const long number = std::stol(match[1]); number > highest) {
      highest = number;
      last = entry.path();
    }
  }
  return last;
}

}  // namespace lipofill::client
