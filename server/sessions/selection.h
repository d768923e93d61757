#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace lipofill::server {

/// The parts of a frame that a viewer is shown, and their encoding. Viewers of equal selections
/// share one encoding.
struct Selection {
  std::vector<std::string> meshes;
  std::vector<std::string> fields = {};  ///< "<mesh>.<field>"; empty: all of the meshes
  bool quantised = false;                ///< uint16 over a box in place of float32

  bool has_mesh(const std::string& mesh) const { return std::find(meshes.begin(), meshes.end(), mesh) != meshes.end(); }
  /// True for a field, by its full name, of a mesh that is selected.
  bool has_field(const std::string& field) const {
    return fields.empty() || std::find(fields.begin(), fields.end(), field) != fields.end();
  }
};

/// Returns "film/deep" of "film/deep.pressure".
inline std::string mesh_of(const std::string& array) {
  return array.substr(0, array.rfind('.'));
}

/// Sorts the names and drops repeated ones, so that viewers who ask for the same in another order
/// share what is made for them.
inline void sort_out(std::vector<std::string>& names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
}

}  // namespace lipofill::server
