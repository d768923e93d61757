// Neo-Hookean tissue keeps its volume: 1 mL in a disc 24 mm wide under each layer of a flat square
// with the figures of elastography. The corotational law loses a tenth of the fat's volume there.

#include "tests/verification/coupling/tissue_volume.h"

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ScalarField;
using solid::TissueLaw;

/// 50 x 50 mm in 40 x 40 hexahedra a layer, the preset's four layers over 4 mm of muscle.
model::FaceModelSpec make_square_spec() {
  model::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{0.05, 0.05};
  spec.n_xi = spec.n_eta = 40;
  spec.layers = {{"skin", {ScalarField::constant(1.8e-3), 1}, {100e3, 0.48, 1100.0}},
                 {"subcutaneous", {ScalarField::constant(3e-3), 1}, {3e3, 0.49, 950.0}},
                 {"smas", {ScalarField::constant(1e-3), 1}, {50e3, 0.45, 1050.0}},
                 {"muscle", {ScalarField::constant(4e-3), 1}, {20e3, 0.49, 1050.0}}};
  return spec;
}

TEST(TissueVolume, IsKeptOnAFlatSquare) {
  expect_volume_kept(make_square_spec(), "flat");
}

/// What the other law loses, as the reason for this one.
TEST(TissueVolume, IsLostByTheCorotationalLaw) {
  Case record({"coupled/11-tissue-volume", "Neo-Hookean tissue keeps its volume", ""});
  const auto model = build_with_law(make_square_spec(), TissueLaw::kCorotational);
  ASSERT_TRUE(model);
  const KeptVolume kept = fill_disc(model, "subcutaneous");
  record.record({"flat, below subcutaneous, corotational: volume under the skin over the fat's", "1", 1.0, kept.skin,
                 0.0, Bound::kReported});
  EXPECT_LT(kept.skin, 0.95);
}

}  // namespace
}  // namespace lipofill::verification
