#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/solid/hex_mesh.h"
#include "core/solid/material.h"
#include "core/solid/tissue.h"
#include "core/solid/tissue_structure.h"

namespace lipofill::solid {

/// Checks the input of TissueStructure::create: INVALID_ARGUMENT with a violation for everything
/// wrong, at most a few of each kind. Checked by tests/unit/solid/tissue_checks_test.cc.
absl::Status check_tissue(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials,
                          const NodeSupports& supports, const std::vector<WallSpring>& springs = {});

/// Checks that there is a modulus [Pa] a material, each finite and positive.
absl::Status check_youngs_moduli(const std::vector<double>& youngs_moduli, int n_materials);

absl::Status check_damping(const RayleighDamping& damping);

}  // namespace lipofill::solid
