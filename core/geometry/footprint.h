#pragma once

#include <Eigen/Core>
#include <string>

namespace lipofill::geometry {

/// An ellipse of skin that a model is to cover.
struct Footprint {
  std::string name;          ///< for messages
  std::string field;         ///< of the wire schema that asks for it
  Eigen::Vector3d centre;    ///< near the skin, or beneath it [m]
  Eigen::Vector3d along;     ///< unit, of the long axis
  double half_length = 0.0;  ///< [m]
  double half_width = 0.0;   ///< [m]
};

/// Smallest share of a zone that must lie on the model. With less, what is asked for is not what is
/// simulated.
inline constexpr double kSmallestZoneShare = 0.6;
/// A zone with less of it on the model than this is remarked upon.
inline constexpr double kWholeZoneShare = 0.98;

}  // namespace lipofill::geometry
