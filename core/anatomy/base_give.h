#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/geometry/face_geometry.h"

namespace lipofill::anatomy {

/// Stiffness per area of what lies beneath the tissue where no bone does: the cheek before the
/// teeth, the floor of the mouth. Assumed; no source has a figure. [Pa/m]
inline constexpr double kSoftBaseStiffness = 1e6;

/// The give of the base at every node of the chart, in [0, 1]: 0 where bone lies beneath the
/// tissue, 1 where none does. With rho_r the distance from the middle of region r in units of its
/// half-axes, measured along the skin,
///
///     give = max_r S((1.3 - rho_r) / 0.6),   S(u) = u^2 (3 - 2 u) on [0, 1]
///
/// over the regions that span from bone to bone: buccal, between cheekbone, upper jaw and mandible,
/// and submaxillary, below the mandible. Everywhere else there is bone (zygoma, maxilla, mandible,
/// temporal bone) or teeth. The width of the blend is assumed. Regions of every side whose
/// landmarks are there take part; nothing when no side has them. Checked by
/// tests/unit/anatomy/base_give_test.cc.
std::optional<Eigen::VectorXd> compute_base_give(const geometry::FaceGeometry& face);

}  // namespace lipofill::anatomy
