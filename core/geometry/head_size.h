#pragma once

#include <optional>

#include "core/geometry/head_axes.h"

namespace lipofill::geometry {

/// Size of the middle of a face relative to an average adult's: the perimeter of the triangle from
/// the outer corner of the eye over the cheekbone to the corner of the mouth, over 0.20798 m (the
/// face of the sample plans), the mean of the sides that have all three. Rounded to four digits,
/// which is finer than a landmark can be placed. Nothing without exocanthion, zygion and cheilion
/// of a side. Checked by tests/unit/geometry/landmark_checks_test.cc.
std::optional<double> compute_head_scale(const Landmarks& landmarks);

/// A distance between two landmarks, and what is usual for it.
struct LandmarkDistance {
  const char* from = nullptr;
  const char* to = nullptr;
  double found = 0.0;  ///< [m]
  double usual = 0.0;  ///< of an adult [m]
};

/// The distance whose ratio to the usual one is the median of all that the landmarks give. Nothing
/// for fewer than four distances, which are too few to tell a unit by.
std::optional<LandmarkDistance> find_typical_distance(const Landmarks& landmarks);

}  // namespace lipofill::geometry
