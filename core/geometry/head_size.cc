#include "core/geometry/head_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace lipofill::geometry {
namespace {

constexpr double kUsualPerimeter = 0.20798;  // [m]
constexpr double kDigits = 1e4;
constexpr size_t kFewestDistances = 4;

/// Distances on the face of the sample plans, whose sizes are those of an average adult [m].
constexpr std::array<LandmarkDistance, 12> kUsualDistances = {{
    {"nasion", "menton", 0.0, 0.109},
    {"nasion", "pronasale", 0.0, 0.040},
    {"nasion", "subnasale", 0.0, 0.050},
    {"zygion_left", "zygion_right", 0.0, 0.140},
    {"exocanthion_left", "exocanthion_right", 0.0, 0.093},
    {"cheilion_left", "cheilion_right", 0.0, 0.048},
    {"exocanthion_left", "zygion_left", 0.0, 0.049},
    {"exocanthion_right", "zygion_right", 0.0, 0.049},
    {"zygion_left", "cheilion_left", 0.0, 0.090},
    {"zygion_right", "cheilion_right", 0.0, 0.090},
    {"zygion_left", "gonion_left", 0.0, 0.061},
    {"zygion_right", "gonion_right", 0.0, 0.061},
}};

const Eigen::Vector3d* find(const Landmarks& landmarks, const std::string& name) {
  const auto found = landmarks.find(name);
  return found == landmarks.end() ? nullptr : &found->second;
}

std::optional<double> compute_perimeter(const Landmarks& landmarks, const std::string& side) {
  const Eigen::Vector3d* eye = find(landmarks, "exocanthion" + side);
  const Eigen::Vector3d* cheekbone = find(landmarks, "zygion" + side);
  const Eigen::Vector3d* mouth = find(landmarks, "cheilion" + side);
  if (eye == nullptr || cheekbone == nullptr || mouth == nullptr) return std::nullopt;
  return (*eye - *cheekbone).norm() + (*cheekbone - *mouth).norm() + (*mouth - *eye).norm();
}

}  // namespace

std::optional<double> compute_head_scale(const Landmarks& landmarks) {
  double sum = 0.0;
  int sides = 0;
  for (const char* side : {"_left", "_right"}) {
    const auto perimeter = compute_perimeter(landmarks, side);
    if (!perimeter) continue;
    sum += *perimeter;
    ++sides;
  }
  if (sides == 0) return std::nullopt;
  return std::round(sum / sides / kUsualPerimeter * kDigits) / kDigits;
}

std::optional<LandmarkDistance> find_typical_distance(const Landmarks& landmarks) {
  std::vector<LandmarkDistance> distances;
  for (LandmarkDistance distance : kUsualDistances) {
    const Eigen::Vector3d* from = find(landmarks, distance.from);
    const Eigen::Vector3d* to = find(landmarks, distance.to);
    if (from == nullptr || to == nullptr) continue;
    distance.found = (*from - *to).norm();
    distances.push_back(distance);
  }
  if (distances.size() < kFewestDistances) return std::nullopt;
  const auto middle = distances.begin() + static_cast<long>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end(),
                   [](const auto& a, const auto& b) { return a.found * b.usual < b.found * a.usual; });
  return *middle;
}

}  // namespace lipofill::geometry
