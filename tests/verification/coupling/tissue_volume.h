#pragma once

#include "core/simulation/simulation.h"

namespace lipofill::verification {

/// What becomes of the volumes when 1 mL is filled into a disc 24 mm wide.
struct KeptVolume {
  double tissue = 0.0;  ///< change of all layers' volume over that volume
  double skin = 0.0;    ///< volume swept by the skin over that of the fat
};

std::shared_ptr<const model::FaceModel> build_with_law(model::FaceModelSpec spec, solid::TissueLaw law);

/// Fills the disc, in the middle of the model below that layer, until it settles.
KeptVolume fill_disc(const std::shared_ptr<const model::FaceModel>& model, const std::string& below);

/// Neo-Hookean layers keep their volume within 0.5 %, and the skin rises by the fat's, whichever
/// layer lies over it.
void expect_volume_kept(const model::FaceModelSpec& spec, const std::string& where);

}  // namespace lipofill::verification
