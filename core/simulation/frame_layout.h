#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/geometry/face_geometry.h"
#include "core/plan/film_layout.h"

namespace lipofill::simulation {

/// A vertex that moves with the skin, between four of its nodes, and the cell of the outermost film
/// below it.
struct SkinPoint {
  int vertex = 0;  ///< counts in the mesh that it belongs to
  std::array<int, 4> nodes{};
  std::array<double, 4> weights{};
  int film = -1;  ///< -1: none below
  int cell = -1;
};

/// The sources of the values of a frame's meshes. Constant: a frame only gathers.
struct FrameLayout {
  std::vector<SkinPoint> skin;
  std::vector<SkinPoint> scan;                      ///< those of its vertices that move
  std::vector<std::vector<int>> film_vertices;      ///< each film has those of its grid that cells touch, in order
  std::vector<std::vector<uint32_t>> film_corners;  ///< each film's cells have four each, among film_vertices
};

/// @param skin  of the simulation whose films these are
/// @param face  whose skin and scan the frame shows: that model's own or another one's of the same chart
/// Checked by tests/unit/simulation/frame_layout_test.cc.
FrameLayout make_frame_layout(const geometry::LayeredGrid& skin, const std::vector<plan::FilmLayout>& films,
                              const geometry::FaceGeometry& face);

}  // namespace lipofill::simulation
