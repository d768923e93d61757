#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/geometry/face_geometry.h"
#include "core/geometry/surface_reader.h"

namespace lipofill::testing {

/// A face of a folder: STEM.ply or STEM.obj beside STEM.landmarks.json, in millimetres.
struct FaceFile {
  std::string stem;
  std::filesystem::path surface;
  std::filesystem::path landmarks;
};

/// The faces of a folder, by name; none when the folder is not there.
inline std::vector<FaceFile> find_face_files(const std::filesystem::path& folder) {
  std::vector<FaceFile> faces;
  if (!std::filesystem::exists(folder)) return faces;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".ply" && extension != ".obj") continue;
    std::filesystem::path landmarks = entry.path();
    landmarks.replace_extension(".landmarks.json");
    if (std::filesystem::exists(landmarks)) faces.push_back({entry.path().stem().string(), entry.path(), landmarks});
  }
  std::sort(faces.begin(), faces.end(), [](const auto& a, const auto& b) { return a.stem < b.stem; });
  return faces;
}

inline std::string read_whole(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

inline Eigen::Vector3d to_vector(const nlohmann::json& xyz) {
  return {xyz[0].get<double>(), xyz[1].get<double>(), xyz[2].get<double>()};
}

/// The scan and its landmarks; a failure when the file cannot be read.
inline geometry::ScanRegionSpec read_face_file(const FaceFile& face) {
  geometry::ScanRegionSpec region;
  const auto format =
      face.surface.extension() == ".ply" ? geometry::SurfaceFormat::kPly : geometry::SurfaceFormat::kObj;
  auto scan = geometry::read_surface(read_whole(face.surface), format, 1e-3);
  EXPECT_TRUE(scan.ok()) << scan.status();
  if (scan.ok()) region.scan = *std::move(scan);
  const auto description = nlohmann::json::parse(read_whole(face.landmarks));
  for (const auto& [name, xyz] : description["landmarks"].items()) region.landmarks[name] = 1e-3 * to_vector(xyz);
  if (description.contains("axes")) {
    const auto& axes = description["axes"];
    region.axes = geometry::HeadAxes{to_vector(axes["left"]), to_vector(axes["up"]), to_vector(axes["forward"])};
  }
  return region;
}

}  // namespace lipofill::testing
