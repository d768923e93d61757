#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "client/cpp/arrays.h"

namespace lipofill::client {

/// The folder a run leaves behind: skin_0000.vtp, film_0000.vtp (film_<name>_0000.vtp when there
/// are several films), tissue_0000.vtu, scan_0000.vtp where the model has a scan, and a .pvd for
/// each that ParaView opens as a series over time; skin_preview.vtp and scan_preview.vtp of a run
/// with a preview. Checked by tests/unit/client/result_folder_test.cc.
class ResultFolder {
 public:
  explicit ResultFolder(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }

  /// Makes the folder and takes away what an earlier run left in it under these names.
  /// INVALID_ARGUMENT where it cannot.
  absl::Status prepare();

  /// The meshes that the frames to come are on.
  void set_meshes(std::vector<Array> meshes) { meshes_ = std::move(meshes); }
  const std::vector<Array>& meshes() const { return meshes_; }

  /// Writes one frame, a file a mesh, under the next number. A frame at the time of the last one is
  /// not written twice.
  absl::Status write_frame(double time_s, const std::vector<Array>& fields);

  /// Writes the preview's meshes, those it has fields on, beside the series.
  absl::Status write_preview(const std::vector<Array>& fields) const;

  int frames() const { return frames_; }

 private:
  std::string stem_of(const std::string& mesh) const;

  std::filesystem::path path_;
  std::vector<Array> meshes_;
  std::map<std::string, std::vector<std::pair<double, std::string>>> collections_;  // a stem has pairs of time and file
  std::optional<double> last_time_s_;
  int frames_ = 0;
};

/// The file with the highest number of those a run has written for a mesh ("skin", "scan", ...);
/// empty when there is none.
std::filesystem::path last_frame_file(const std::filesystem::path& folder, const std::string& stem);

}  // namespace lipofill::client
