#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/face_geometry.h"
#include "core/solid/material.h"

namespace lipofill::simulation {

enum class SupportKind { kClamped, kRollers, kFree, kElastic };

/// How a side or the base of the tissue is held.
struct Support {
  SupportKind kind = SupportKind::kClamped;
  double stiffness = 0.0;  ///< [Pa/m], kElastic only
};

struct TissueLayerSpec {
  std::string name;
  geometry::LayerGeometry geometry;
  solid::ElasticMaterial material;
};

/// All that a model is made from; lipofill.v1.ModelSpec in SI.
struct FaceModelSpec {
  std::variant<geometry::SquareSpec, geometry::ScanRegionSpec> region;
  int n_xi = 0;
  int n_eta = 0;
  std::vector<TissueLayerSpec> layers;
  Support rim;
  Support base;
};

/// A patient's layered face model. Immutable once built and shared between simulations.
struct FaceModel {
  geometry::FaceGeometry geometry;
  std::vector<TissueLayerSpec> layers;
  Support rim;
  Support base;
  bool is_square = false;
  std::string content_hash;  ///< SHA-256 of everything a simulation depends on
};

/// INVALID_ARGUMENT with field violations named as in lipofill.v1.ModelSpec, FAILED_PRECONDITION from the scan,
/// CANCELLED. Deterministic: the same specification gives the same content hash.
absl::StatusOr<std::shared_ptr<const FaceModel>> build_face_model(const FaceModelSpec& spec,
                                                                  const geometry::Progress& progress);

}  // namespace lipofill::simulation
