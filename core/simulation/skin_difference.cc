#include "core/simulation/skin_difference.h"

#include <algorithm>
#include <cmath>

namespace lipofill::simulation {
namespace {

/// Displacement of the skin in a frame [mm] (3 n).
std::vector<float> find_skin_displacement(const std::vector<FrameField>& fields) {
  for (const FrameField& field : fields) {
    if (field.mesh == "skin" && field.name == "displacement") return field.values;
  }
  return {};
}

}  // namespace

std::vector<double> squared_skin_distances(const std::vector<FrameField>& a, const std::vector<FrameField>& b) {
  const std::vector<float> of_a = find_skin_displacement(a);
  const std::vector<float> of_b = find_skin_displacement(b);
  std::vector<double> squares;
  for (size_t k = 0; k + 2 < std::min(of_a.size(), of_b.size()); k += 3) {
    double square = 0.0;
    for (size_t c = k; c < k + 3; ++c) square += std::pow(static_cast<double>(of_a[c]) - of_b[c], 2);
    squares.push_back(square);
  }
  return squares;
}

}  // namespace lipofill::simulation
