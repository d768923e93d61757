#include "core/model/face_model.h"

#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/anatomy/base_give.h"
#include "core/base/field_violations.h"
#include "core/base/hash.h"
#include "core/base/units.h"
#include "core/geometry/gap_filling.h"
#include "core/model/face_model_check.h"
#include "core/model/layer_thickness.h"
#include "core/model/region_footprints.h"

namespace lipofill::model {
namespace {

/// Share of the building work that comes before the layers.
constexpr double kSkinFraction = 0.9;
/// Layers that fold are tried with less margin this often.
constexpr int kMostTrials = 6;

void check_layer(const TissueLayerSpec& layer, const std::string& field, FieldViolations& violations) {
  violations.check_range(absl::StrCat(field, ".youngs_modulus_kpa"),
                         layer.material.youngs_modulus / kPascalsPerKilopascal, 0.01, 1e6, "kPa");
  violations.check_half_open(absl::StrCat(field, ".poisson_ratio"), layer.material.poisson_ratio, 0.0, 0.5, "");
  violations.check_range(absl::StrCat(field, ".density_kg_m3"), layer.material.density, 1.0, 30000.0, "kg/m3");
  violations.check_range(absl::StrCat(field, ".prestress_kpa"), layer.material.prestress / kPascalsPerKilopascal, 0.0,
                         1000.0, "kPa");
}

void check_support(const Support& support, const char* field, bool is_square, FieldViolations& violations) {
  if (support.kind == SupportKind::kElastic || support.kind == SupportKind::kByRegion) {
    violations.check_range(absl::StrCat(field, ".stiffness_kpa_per_mm"),
                           support.stiffness / kPascalsPerMetrePerKilopascalPerMillimetre, 1e-9, 1e9, "kPa/mm");
  }
  if (support.kind == SupportKind::kRollers && !is_square) {
    violations.add(absl::StrCat(field, ".kind"), "is ROLLERS, which needs a square: a scan's sides are not planes");
  }
  if (support.kind == SupportKind::kByRegion && is_square) {
    violations.add(absl::StrCat(field, ".kind"), "is BY_REGION, which needs a scan_region: a square has no anatomy");
  }
}

void add_matrix(Hasher& hasher, const Eigen::Matrix3Xd& matrix) {
  hasher.add(static_cast<uint64_t>(matrix.cols()));
  hasher.add_bytes(matrix.data(), static_cast<size_t>(matrix.size()) * sizeof(double));
}

/// Adds the prestress to the hash, at the end and only if there is one: a model without has the
/// hash it had before layers had a prestress.
void add_prestress(Hasher& hasher, const std::vector<TissueLayerSpec>& layers) {
  const auto is_tense = [](const TissueLayerSpec& layer) { return layer.material.prestress != 0.0; };
  if (std::none_of(layers.begin(), layers.end(), is_tense)) return;
  hasher.add("prestress");
  for (const TissueLayerSpec& layer : layers) hasher.add(layer.material.prestress);
}

/// Adds the laws to the hash, at the end and only if one is not the paper's: such a model keeps the
/// hash it had before layers had a law.
void add_laws(Hasher& hasher, const std::vector<TissueLayerSpec>& layers) {
  const auto is_other = [](const TissueLayerSpec& layer) {
    return layer.material.law != solid::TissueLaw::kCorotational;
  };
  if (std::none_of(layers.begin(), layers.end(), is_other)) return;
  hasher.add("laws");
  for (const TissueLayerSpec& layer : layers) hasher.add(static_cast<int>(layer.material.law));
}

std::string compute_content_hash(const FaceModel& model) {
  Hasher hasher;
  hasher.add("lipofill face model 1");
  const geometry::LayeredGrid& grid = model.geometry.grid;
  for (const int n : {grid.n_xi, grid.n_eta}) hasher.add(n);
  hasher.add(grid.elements_through);
  add_matrix(hasher, grid.nodes);
  add_matrix(hasher, model.geometry.scan.points);
  for (const auto& triangle : model.geometry.scan.triangles) hasher.add_bytes(triangle.data(), sizeof triangle);
  for (const geometry::Rider& rider : model.geometry.riders) {
    hasher.add(rider.vertex);
    hasher.add(rider.place.xi);
    hasher.add(rider.place.eta);
  }
  for (const auto& [name, position] : model.geometry.landmarks) {
    hasher.add(name);
    hasher.add_bytes(position.data(), 3 * sizeof(double));
  }
  for (const Eigen::Vector3d* axis :
       {&model.geometry.axes.left, &model.geometry.axes.up, &model.geometry.axes.forward}) {
    hasher.add_bytes(axis->data(), 3 * sizeof(double));
  }
  for (const TissueLayerSpec& layer : model.layers) {
    hasher.add(layer.name);
    hasher.add(layer.material.youngs_modulus);
    hasher.add(layer.material.poisson_ratio);
    hasher.add(layer.material.density);
  }
  for (const Support& support : {model.rim, model.base}) {
    hasher.add(static_cast<int>(support.kind));
    hasher.add(support.stiffness);
  }
  hasher.add(model.is_square);
  add_prestress(hasher, model.layers);
  add_laws(hasher, model.layers);
  if (model.base_give.size() > 0) {
    hasher.add("base give");
    hasher.add_bytes(model.base_give.data(), static_cast<size_t>(model.base_give.size()) * sizeof(double));
  }
  return hasher.hex_digest();
}

absl::StatusOr<geometry::FaceGeometrySpec> make_geometry_spec(const FaceModelSpec& spec,
                                                              const std::vector<Eigen::Vector3d>& sharp_bends) {
  geometry::FaceGeometrySpec geometry_spec;
  geometry_spec.region = spec.region;
  if (spec.around) {
    auto& scan = std::get<geometry::ScanRegionSpec>(geometry_spec.region);
    auto footprints = find_footprints(scan, *spec.around);
    if (!footprints.ok()) return footprints.status();
    scan.footprints = *std::move(footprints);
    scan.margin = spec.around->margin;
    scan.sharp_bends = sharp_bends;
  }
  geometry_spec.n_xi = spec.n_xi;
  geometry_spec.n_eta = spec.n_eta;
  for (const TissueLayerSpec& layer : spec.layers) {
    geometry_spec.layers.push_back(layer.geometry);
    geometry_spec.layers.back().thickness = geometry::without_gaps(layer.geometry.thickness);
    // The layer is as thick as it can be until the bone is measured.
    if (layer.down_to_bone) {
      geometry_spec.layers.back().thickness = geometry::ScalarField::constant(layer.down_to_bone->max_thickness);
    }
  }
  return geometry_spec;
}

/// The charted skin, without the layers: their thickness depends on where they lie. Everything
/// wrong with the layers is told before the scan is worked on.
absl::StatusOr<geometry::FaceGeometry> build_skin(const FaceModelSpec& spec,
                                                  const std::vector<Eigen::Vector3d>& sharp_bends,
                                                  const geometry::Progress& progress) {
  auto geometry_spec = make_geometry_spec(spec, sharp_bends);
  if (!geometry_spec.ok()) return geometry_spec.status();
  if (const absl::Status valid = geometry::check_face_geometry(*geometry_spec); !valid.ok()) return valid;
  geometry_spec->layers.clear();
  return geometry::build_face_geometry(*geometry_spec, [&progress](double fraction, const char* stage) {
    return !progress || progress(kSkinFraction * fraction, stage);
  });
}

/// Adds advice to the error when layers fold: what else may be the cause, and what the caller can
/// change. Over a rough scan the roughness is the first cause to look at; a thickness that follows
/// the bone has two more parameters.
absl::Status with_advice(const absl::Status& status, const geometry::FaceGeometry& face,
                         const LayerThickness& thickness, const std::optional<AroundSpec>& around) {
  if (!absl::IsFailedPrecondition(status)) return status;
  std::string text(status.message());
  if (face.rms_rider_distance > geometry::kRoughScan) {
    text = absl::StrFormat(
        "the scan is noisy: its vertices lie %.2f mm (rms) off the smoothed skin, %.2f mm at most; smooth it first. "
        "(%s)",
        face.rms_rider_distance * kMillimetresPerMetre, face.max_rider_distance * kMillimetresPerMetre, text);
  }
  if (thickness.bone) text += "; or raise smoothing_mm or lower max_thickness_mm of the layer down to the bone";
  if (around && !around->regions.empty()) {
    absl::StrAppend(&text, "; the place lies within or beside ", absl::StrJoin(around->regions, ", "),
                    ", where its landmarks put it, and cannot be left out of the model");
  }
  return absl::FailedPreconditionError(text);
}

/// A face with its layers, and the thickness they came to.
struct LayeredFace {
  geometry::FaceGeometry geometry;
  LayerThickness thickness;
};

/// Lays the layers under the charted skin. Where they fold beside what the model goes around, the
/// skin is charted anew with less margin there.
absl::StatusOr<LayeredFace> build_layered_face(const FaceModelSpec& spec, const geometry::Progress& progress) {
  std::vector<Eigen::Vector3d> sharp_bends;
  for (int trial = 0;; ++trial) {
    auto face = build_skin(spec, sharp_bends, trial == 0 ? progress : nullptr);
    if (!face.ok()) return face.status();
    if (progress && !progress(kSkinFraction, "laying the layers"))
      return absl::CancelledError("building was cancelled");
    auto thickness = find_layer_thickness(*face, spec);
    if (!thickness.ok()) return thickness.status();
    std::vector<geometry::LayerGeometry> layers;
    for (size_t l = 0; l < spec.layers.size(); ++l) {
      layers.push_back({thickness->fields[l], spec.layers[l].geometry.elements_through});
    }
    std::vector<Eigen::Vector3d> folded;
    const absl::Status laid = geometry::lay_layers(layers, *face, &folded);
    if (laid.ok()) return LayeredFace{*std::move(face), *std::move(thickness)};
    const bool is_known = std::all_of(folded.begin(), folded.end(), [&](const Eigen::Vector3d& place) {
      return std::find(sharp_bends.begin(), sharp_bends.end(), place) != sharp_bends.end();
    });
    if (!spec.around || is_known || trial == kMostTrials) return with_advice(laid, *face, *thickness, spec.around);
    sharp_bends.insert(sharp_bends.end(), folded.begin(), folded.end());
  }
}

/// Everything wrong with what the region is to hold is told before the scan is worked on.
void check_around(const FaceModelSpec& spec, FieldViolations& violations) {
  if (!spec.around) return;
  const absl::Status found = find_footprints(std::get<geometry::ScanRegionSpec>(spec.region), *spec.around).status();
  violations.absorb(absl::IsInvalidArgument(found) ? "" : "scan_region.landmarks_mm", found);
}

/// Places bone and what gives under the tissue: as measured where a layer goes down to the bone,
/// else by the landmarks. Says what it assumed.
void lay_base(const FaceModelSpec& spec, const LayerThickness& thickness, FaceModel& model) {
  model.base = spec.base;
  if (spec.base.kind != SupportKind::kByRegion) return;
  std::vector<std::string>& remarks = model.geometry.cautions;
  if (thickness.bone) {
    model.base_give = thickness.off_bone.cwiseMax(0.0).cwiseMin(1.0);
  } else if (auto give = anatomy::compute_base_give(model.geometry)) {
    model.base_give = *std::move(give);
  } else {
    model.base = {SupportKind::kClamped, 0.0};
    remarks.push_back(
        "Bone is assumed under the whole region: the landmarks zygion, gonion and cheilion of a side, _left or "
        "_right, would show where there is none.");
    return;
  }
  if (model.base_give.maxCoeff() <= kLeastGive) return;
  remarks.push_back(absl::StrFormat(
      "No bone lies beneath %.0f %% of the region%s: the tissue rests there on springs of %.2f kPa/mm%s.",
      100.0 * model.base_give.mean(), thickness.bone ? " by the scan of the bone" : " by the landmarks",
      spec.base.stiffness / kPascalsPerMetrePerKilopascalPerMillimetre,
      spec.base.stiffness == anatomy::kSoftBaseStiffness ? ", an assumed figure (base.stiffness_kpa_per_mm)" : ""));
}

}  // namespace

absl::Status check_face_model(const FaceModelSpec& spec) {
  const bool is_square = std::holds_alternative<geometry::SquareSpec>(spec.region);
  FieldViolations violations;
  if (spec.layers.empty() && !is_square) violations.add("layers", "there are none; a scan needs at least 1");
  std::set<std::string> names;
  for (size_t l = 0; l < spec.layers.size(); ++l) {
    const std::string field = absl::StrCat("layers[", l, "]");
    const std::string& name = spec.layers[l].name;
    if (name.empty()) violations.add(field + ".name", "is empty");
    if (!names.insert(name).second) violations.add(field + ".name", absl::StrCat("is '", name, "' a second time"));
    check_layer(spec.layers[l], field, violations);
  }
  check_thickness_requests(spec, violations);
  check_around(spec, violations);
  check_support(spec.rim, "rim", is_square, violations);
  if (spec.rim.kind == SupportKind::kByRegion) {
    violations.add("rim.kind", "is BY_REGION, which only a base can be; must be CLAMPED, FREE or ELASTIC");
  }
  check_support(spec.base, "base", is_square, violations);
  return violations.to_status();
}

absl::StatusOr<std::shared_ptr<const FaceModel>> build_face_model(const FaceModelSpec& spec,
                                                                  const geometry::Progress& progress) {
  auto model = std::make_shared<FaceModel>();
  model->is_square = std::holds_alternative<geometry::SquareSpec>(spec.region);
  if (const absl::Status status = check_face_model(spec); !status.ok()) return status;

  auto face = build_layered_face(spec, progress);
  if (!face.ok()) return face.status();
  LayerThickness& thickness = face->thickness;

  model->geometry = std::move(face->geometry);
  model->layers = spec.layers;
  for (size_t l = 0; l < spec.layers.size(); ++l) {
    model->layers[l].geometry = {std::move(thickness.fields[l]), model->geometry.grid.elements_through[l]};
  }
  model->thickness = std::move(thickness.ranges);
  model->bone = thickness.bone;
  std::vector<std::string>& cautions = model->geometry.cautions;
  cautions.insert(cautions.end(), thickness.remarks.begin(), thickness.remarks.end());
  model->rim = spec.rim;
  lay_base(spec, thickness, *model);
  model->content_hash = compute_content_hash(*model);
  if (progress && !progress(1.0, "done")) return absl::CancelledError("building was cancelled");
  return std::shared_ptr<const FaceModel>(std::move(model));
}

}  // namespace lipofill::model
