#include "core/planning/face_part.h"

#include <algorithm>

namespace lipofill::planning {
namespace {

constexpr double kBeyondLandmarks = 1.25;

}  // namespace

std::optional<FaceBall> find_face_ball(const geometry::Landmarks& landmarks) {
  if (landmarks.size() < 3) return std::nullopt;
  FaceBall ball;
  double n = 0.0;
  for (const char* stem : {"exocanthion", "cheilion", "zygion", "gonion"}) {
    for (const char* side : {"_left", "_right"}) {
      const auto found = landmarks.find(std::string(stem) + side);
      if (found == landmarks.end()) continue;
      ball.centre += found->second;
      n += 1.0;
    }
  }
  if (n == 0.0) {
    for (const auto& [name, position] : landmarks) ball.centre += position, n += 1.0;
  }
  ball.centre /= n;
  for (const auto& [name, position] : landmarks) ball.radius = std::max(ball.radius, (position - ball.centre).norm());
  ball.radius *= kBeyondLandmarks;
  return ball;
}

std::vector<int> find_triangles_in(const SkinSurface& skin, const FaceBall& ball) {
  std::vector<int> inside;
  for (int t = 0; t < skin.mesh.n_triangles(); ++t) {
    const auto& triangle = skin.mesh.triangles[t];
    const bool in = std::all_of(triangle.begin(), triangle.end(),
                                [&](int v) { return (skin.mesh.points.col(v) - ball.centre).norm() <= ball.radius; });
    if (in) inside.push_back(t);
  }
  return inside;
}

}  // namespace lipofill::planning
