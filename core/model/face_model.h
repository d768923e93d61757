#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "core/anatomy/tissue_presets.h"
#include "core/geometry/face_geometry.h"
#include "core/solid/material.h"

namespace lipofill::model {

/// kByRegion is for a base only: bone where the face has bone, springs where it has none.
enum class SupportKind { kClamped, kRollers, kFree, kElastic, kByRegion };

/// The way a side or the base of the tissue is held.
struct Support {
  SupportKind kind = SupportKind::kClamped;
  double stiffness = 0.0;  ///< [Pa/m], kElastic; kByRegion where no bone lies beneath
};

/// A base that gives less than this counts as bone.
inline constexpr double kLeastGive = 0.02;

/// A layer takes what the others leave of the distance from skin to bone.
struct DownToBone {
  double min_thickness = 1e-3;   ///< [m] less anywhere is an error
  double max_thickness = 30e-3;  ///< [m] where bone lies deeper the layer ends here
  double smoothing = 6e-3;       ///< [m] of the depth; 0: none
};

struct TissueLayerSpec {
  std::string name;
  geometry::LayerGeometry geometry;  ///< a built model has what it came to
  solid::ElasticMaterial material;
  std::optional<anatomy::TissueKind> kind = std::nullopt;
  bool regional_thickness = false;  ///< published figures of the kind in some regions, the thickness outside
  std::optional<DownToBone> down_to_bone = std::nullopt;  ///< it takes the place of the thickness
};

/// A disc of skin that a model is to hold.
struct AroundDisc {
  geometry::SkinPoint centre;
  double radius = 0.0;  ///< [m]
};

/// This says what a model is to hold, in place of the corners of its region.
struct AroundSpec {
  std::vector<std::string> regions;  ///< named regions of the face
  std::vector<AroundDisc> discs;
  double margin = 12e-3;  ///< [m] of skin around them
};

/// All that a model is made from; lipofill.v1.ModelSpec in SI.
struct FaceModelSpec {
  std::variant<geometry::SquareSpec, geometry::ScanRegionSpec> region;
  int n_xi = 0;   ///< 0: it follows from the size of the region (geometry/default_size.h)
  int n_eta = 0;  ///< the same
  std::vector<TissueLayerSpec> layers;
  Support rim;
  Support base;
  std::optional<geometry::SurfaceMesh> bone;  ///< in the frame of the scan
  std::optional<AroundSpec> around;           ///< of a scan region without corners
};

/// Thickness of a layer over the nodes of the chart [m].
struct ThicknessRange {
  double min = 0.0;
  double mean = 0.0;
  double max = 0.0;
};

/// The finding tells how much of the bone was found; shares are of the nodes of the chart.
struct BoneFinding {
  double measured_share = 0.0;  ///< where a ray met bone
  double limited_share = 0.0;   ///< where the layer ends above the bone, at its greatest thickness
  ThicknessRange depth;         ///< the depths count from the skin
};

struct SharedParts;
std::shared_ptr<SharedParts> make_shared_parts();

/// A patient's layered face model. Immutable once built and shared between simulations.
struct FaceModel {
  geometry::FaceGeometry geometry;
  std::vector<TissueLayerSpec> layers;
  Support rim;
  Support base;
  Eigen::VectorXd base_give;              ///< (nodes_per_level) see anatomy/base_give.h; kByRegion only
  std::vector<ThicknessRange> thickness;  ///< there is a range for each layer
  std::optional<BoneFinding> bone;
  bool is_square = false;
  std::string content_hash;                                   ///< SHA-256 of everything a simulation depends on
  std::shared_ptr<SharedParts> shared = make_shared_parts();  ///< its simulations share them (shared_parts.h)
};

/// Builds the model. INVALID_ARGUMENT with field violations named as in lipofill.v1.ModelSpec,
/// FAILED_PRECONDITION from the scan, CANCELLED. Deterministic: the same specification gives the
/// same content hash.
absl::StatusOr<std::shared_ptr<const FaceModel>> build_face_model(const FaceModelSpec& spec,
                                                                  const geometry::Progress& progress);

}  // namespace lipofill::model
