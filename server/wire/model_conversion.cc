#include "server/wire/model_conversion.h"

#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/anatomy/base_give.h"
#include "core/base/units.h"
#include "core/geometry/gap_filling.h"
#include "server/wire/chart_conversion.h"
#include "server/wire/tissue_figures.h"

namespace lipofill::server {
namespace {

geometry::HeadAxes read_axes(const v1::HeadAxes& message, const FieldReader& reader) {
  return {read_vector(message.left(), 1.0, reader.below("left")), read_vector(message.up(), 1.0, reader.below("up")),
          read_vector(message.forward(), 1.0, reader.below("forward"))};
}

geometry::ScanRegionSpec read_scan_region(const v1::ScanRegion& message, const FieldReader& reader) {
  geometry::ScanRegionSpec region;
  if (message.scan().empty()) reader.missing("scan");
  for (const auto& [name, position] : message.landmarks_mm()) {
    const FieldReader landmark = reader.below(absl::StrCat("landmarks_mm[", name, "]"));
    region.landmarks[name] = read_vector(position, kMetresPerMillimetre, landmark);
  }
  if (message.has_axes()) region.axes = read_axes(message.axes(), reader.below("axes"));
  if (message.has_around()) {
    if (message.corners_size() > 0) reader.wrong("corners", "are given, and so is around: one of them at most");
    return region;
  }
  if (message.corners_size() != 4) {
    reader.wrong("corners", absl::StrCat("are ", message.corners_size(),
                                         ", must be 4, or none with around, from which the region follows"));
    return region;
  }
  for (int i = 0; i < 4; ++i) region.corners[i] = read_skin_point(message.corners(i), reader.below("corners", i));
  return region;
}

model::AroundSpec read_around(const v1::Around& message, const FieldReader& reader) {
  model::AroundSpec around;
  around.regions = {message.regions().begin(), message.regions().end()};
  for (int i = 0; i < message.discs_size(); ++i) {
    const v1::SkinDisc& disc = message.discs(i);
    const FieldReader below = reader.below("discs", i);
    around.discs.push_back({read_skin_point(disc.centre(), below.below("centre")),
                            below.required(disc.has_radius_mm(), disc.radius_mm(), kMetresPerMillimetre, "radius_mm")});
  }
  if (message.has_margin_mm()) around.margin = message.margin_mm() * kMetresPerMillimetre;
  return around;
}

model::Support read_support(const v1::Support& message, const FieldReader& reader) {
  model::Support support;
  switch (message.kind()) {
    case v1::Support::BY_REGION:
      support.kind = model::SupportKind::kByRegion;
      support.stiffness = message.has_stiffness_kpa_per_mm()
                              ? message.stiffness_kpa_per_mm() * kPascalsPerMetrePerKilopascalPerMillimetre
                              : anatomy::kSoftBaseStiffness;
      break;
    case v1::Support::ROLLERS:
      support.kind = model::SupportKind::kRollers;
      break;
    case v1::Support::FREE:
      support.kind = model::SupportKind::kFree;
      break;
    case v1::Support::ELASTIC:
      support.kind = model::SupportKind::kElastic;
      support.stiffness = reader.required(message.has_stiffness_kpa_per_mm(), message.stiffness_kpa_per_mm(),
                                          kPascalsPerMetrePerKilopascalPerMillimetre, "stiffness_kpa_per_mm");
      break;
    default:
      support.kind = model::SupportKind::kClamped;
  }
  return support;
}

model::DownToBone read_down_to_bone(const v1::DownToBone& message) {
  model::DownToBone bounds;
  if (message.has_min_thickness_mm()) bounds.min_thickness = message.min_thickness_mm() * kMetresPerMillimetre;
  if (message.has_max_thickness_mm()) bounds.max_thickness = message.max_thickness_mm() * kMetresPerMillimetre;
  if (message.has_smoothing_mm()) bounds.smoothing = message.smoothing_mm() * kMetresPerMillimetre;
  return bounds;
}

/// A field in which samples that are not a number say that nothing was measured there; the model
/// checks what else they say. What is wrong about the others is told as of any field.
geometry::ScalarField read_field_with_gaps(const v1::ScalarField& message, const FieldReader& reader) {
  v1::ScalarField known = message;
  if (message.has_samples()) {
    geometry::ScalarField field;
    field.values.assign(message.samples().values().begin(), message.samples().values().end());
    const std::vector<double> filled = geometry::without_gaps(field).values;
    known.mutable_samples()->mutable_values()->Assign(filled.begin(), filled.end());
  }
  geometry::ScalarField field = read_scalar_field(known, kMetresPerMillimetre, reader);
  if (field.values.size() != static_cast<size_t>(message.samples().values_size())) return field;
  for (size_t k = 0; k < field.values.size(); ++k) {
    const double value = message.samples().values(static_cast<int>(k));
    if (std::isnan(value)) field.values[k] = value;
  }
  return field;
}

void read_thickness(const v1::TissueLayer& message, const std::string& if_missing, const FieldReader& reader,
                    model::TissueLayerSpec& layer) {
  layer.regional_thickness = message.regional_thickness();
  if (message.has_down_to_bone()) {
    layer.down_to_bone = read_down_to_bone(message.down_to_bone());
    if (message.has_thickness_mm())
      reader.wrong("thickness_mm", "is given, and so is down_to_bone: one of them at most");
  } else if (message.has_thickness_mm()) {
    layer.geometry.thickness = read_field_with_gaps(message.thickness_mm(), reader.below("thickness_mm"));
  } else {
    reader.wrong("thickness_mm", if_missing);
  }
}

solid::TissueLaw read_law(v1::TissueLayer::Law law, const FieldReader& reader) {
  switch (law) {
    case v1::TissueLayer::LAW_UNSPECIFIED:
    case v1::TissueLayer::COROTATIONAL:
      return solid::TissueLaw::kCorotational;
    case v1::TissueLayer::NEO_HOOKEAN:
      return solid::TissueLaw::kNeoHookean;
    default:
      reader.wrong("law", absl::StrCat("is ", law, ", must be COROTATIONAL or NEO_HOOKEAN"));
      return solid::TissueLaw::kCorotational;
  }
}

/// A layer whose figures the preset has filled in, as far as it can.
model::TissueLayerSpec read_layer(const v1::TissueLayer& message, const std::string& if_missing,
                                  const FieldReader& reader) {
  model::TissueLayerSpec layer;
  layer.name = message.name();
  if (message.name().empty()) reader.missing("name");
  layer.kind = kind_of(message);
  read_thickness(message, if_missing, reader, layer);
  layer.geometry.elements_through =
      reader.count_or_choice(message.has_elements_through(), message.elements_through(), "elements_through");
  const auto figure = [&](bool has, double value, double factor, const char* field) {
    if (!has) reader.wrong(field, if_missing);
    return value * factor;
  };
  layer.material.youngs_modulus = figure(message.has_youngs_modulus_kpa(), message.youngs_modulus_kpa(),
                                         kPascalsPerKilopascal, "youngs_modulus_kpa");
  layer.material.poisson_ratio = figure(message.has_poisson_ratio(), message.poisson_ratio(), 1.0, "poisson_ratio");
  layer.material.density = figure(message.has_density_kg_m3(), message.density_kg_m3(), 1.0, "density_kg_m3");
  layer.material.prestress = message.prestress_kpa() * kPascalsPerKilopascal;
  layer.material.law = read_law(message.law(), reader);
  return layer;
}

}  // namespace

absl::StatusOr<model::FaceModelSpec> to_face_model_spec(const v1::ModelSpec& given) {
  const v1::ModelSpec message = fill_tissue_figures(given);
  FieldViolations violations;
  const FieldReader reader("", violations);
  model::FaceModelSpec spec;
  if (message.has_square()) {
    const v1::Square& square = message.square();
    const FieldReader below = reader.below("square");
    spec.region = geometry::SquareSpec{
        below.required(square.has_length_xi_mm(), square.length_xi_mm(), kMetresPerMillimetre, "length_xi_mm"),
        below.required(square.has_length_eta_mm(), square.length_eta_mm(), kMetresPerMillimetre, "length_eta_mm")};
  } else if (message.has_scan_region()) {
    const FieldReader below = reader.below("scan_region");
    spec.region = read_scan_region(message.scan_region(), below);
    if (message.scan_region().has_around()) {
      spec.around = read_around(message.scan_region().around(), below.below("around"));
    }
  } else {
    reader.wrong("square", "is missing, and so is scan_region: one of them says where the model is");
  }
  spec.n_xi = reader.count_or_choice(message.has_n_xi(), message.n_xi(), "n_xi");
  spec.n_eta = reader.count_or_choice(message.has_n_eta(), message.n_eta(), "n_eta");
  for (int i = 0; i < message.layers_size(); ++i) {
    const v1::TissueLayer& layer = message.layers(i);
    spec.layers.push_back(read_layer(layer, describe_missing_figure(message, layer), reader.below("layers", i)));
  }
  spec.rim = read_support(message.rim(), reader.below("rim"));
  spec.base = read_support(message.base(), reader.below("base"));
  if (!violations.empty()) return violations.to_status();
  return spec;
}

}  // namespace lipofill::server
