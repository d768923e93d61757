#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/anatomy/tissue_presets.h"
#include "core/geometry/face_geometry.h"

namespace lipofill::anatomy {

/// Thickness of a layer at every node of the chart: what was published for its kind in a region of
/// the face, going over into the layer's general thickness outside.
///
/// | region                                  | skin to superficial fascia | skin   | muscle  |
/// |-----------------------------------------|----------------------------|--------|---------|
/// | masseter (premasseteric)                | 4.25 (+- 0.6) mm           | 1.8 mm | 10 mm   |
/// | buccal                                  | 4.82 (+- 0.9) mm           | 1.8 mm | -       |
///
/// Skin to superficial fascia: pubmed 30882511; a subcutaneous layer takes what the layers over it
/// leave of that. Skin: Clin Anat 2019. Masseter: Kiliaridis 1991. With rho_r the distance from the
/// middle of region r in units of its half-axes, measured along the skin,
///
///     t = (sum_r w_r t_r + (1 - min(1, sum_r w_r)) t_general) / max(1, sum_r w_r),   w_r = S((1.5 - rho_r) / 0.5)
///
/// where S(u) = u^2 (3 - 2 u) on [0, 1]: the published figure within the region, the general one
/// from half as far again. The shape of the blend is assumed.
///
/// @param face     its skin and landmarks; the regions of every side whose landmarks are there take
///                 part
/// @param above    thickness of all the layers over this one at each node of the skin [m]
/// @param general  of this layer at each node of the skin [m]
/// INVALID_ARGUMENT with the field violation "" for a kind without a regional figure, landmarks
/// that are not there, and a place where the layers above leave less than 0.2 mm of the published
/// distance. Checked by tests/unit/anatomy/regional_thickness_test.cc.
absl::StatusOr<Eigen::VectorXd> compute_regional_thickness(const geometry::FaceGeometry& face, TissueKind kind,
                                                           const Eigen::VectorXd& above,
                                                           const Eigen::VectorXd& general);

}  // namespace lipofill::anatomy
