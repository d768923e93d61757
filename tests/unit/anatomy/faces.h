#pragma once

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "core/geometry/face_geometry.h"
#include "core/geometry/surface_reader.h"

namespace lipofill::anatomy {

/// The face shipped with the project, or another in the same form.
inline geometry::ScanRegionSpec read_face(const std::string& folder, const std::string& stem) {
  geometry::ScanRegionSpec region;
  std::ifstream surface(folder + "/" + stem + ".obj", std::ios::binary);
  std::stringstream text;
  text << surface.rdbuf();
  auto scan = geometry::read_surface(text.str(), geometry::SurfaceFormat::kObj, 1e-3);
  EXPECT_TRUE(scan.ok()) << scan.status();
  if (scan.ok()) region.scan = *std::move(scan);
  std::ifstream description(folder + "/" + stem + ".landmarks.json");
  const nlohmann::json json = nlohmann::json::parse(description);
  const auto to_vector = [](const nlohmann::json& xyz) {
    return Eigen::Vector3d(xyz[0].get<double>(), xyz[1].get<double>(), xyz[2].get<double>());
  };
  for (const auto& [name, xyz] : json["landmarks"].items()) region.landmarks[name] = 1e-3 * to_vector(xyz);
  const nlohmann::json& axes = json["axes"];
  region.axes = geometry::HeadAxes{to_vector(axes["left"]), to_vector(axes["up"]), to_vector(axes["forward"])};
  return region;
}

/// Skin alone, from the chin to the ear and up to the cheek bone, on the left.
inline std::array<geometry::SkinPoint, 4> make_half_face_corners() {
  constexpr double kMm = 1e-3;
  using geometry::LandmarkPoint;
  return {LandmarkPoint{{{"menton", 1.0}}, 2 * kMm, 0, 0},
          LandmarkPoint{{{"gonion_left", 1.0}}, -2 * kMm, -17 * kMm, -12 * kMm},
          LandmarkPoint{{{"zygion_left", 1.0}}, 1 * kMm, 12 * kMm, -6 * kMm},
          LandmarkPoint{{{"exocanthion_left", 0.7}, {"subnasale", 0.3}}, 4 * kMm, -8 * kMm, 0}};
}

/// A charted face without tissue under it.
inline absl::StatusOr<geometry::FaceGeometry> chart_face(geometry::ScanRegionSpec region) {
  geometry::FaceGeometrySpec spec;
  spec.region = std::move(region);
  spec.n_xi = spec.n_eta = 30;
  return geometry::build_face_geometry(spec, nullptr);
}

}  // namespace lipofill::anatomy
