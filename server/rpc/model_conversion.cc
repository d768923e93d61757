#include "server/rpc/model_conversion.h"

#include "absl/strings/str_cat.h"
#include "server/rpc/chart_conversion.h"

namespace lipofill::server {
namespace {

constexpr double kPascalPerKilopascal = 1e3;
constexpr double kPascalPerMetrePerKilopascalPerMillimetre = 1e6;

geometry::HeadAxes read_axes(const v1::HeadAxes& message, const FieldReader& reader) {
  return {read_vector(message.left(), 1.0, reader.below("left")), read_vector(message.up(), 1.0, reader.below("up")),
          read_vector(message.forward(), 1.0, reader.below("forward"))};
}

geometry::ScanRegionSpec read_scan_region(const v1::ScanRegion& message, const FieldReader& reader) {
  geometry::ScanRegionSpec region;
  if (message.scan().empty()) reader.missing("scan");
  for (const auto& [name, position] : message.landmarks_mm()) {
    const FieldReader landmark = reader.below(absl::StrCat("landmarks_mm[", name, "]"));
    region.landmarks[name] = read_vector(position, kMetrePerMillimetre, landmark);
  }
  if (message.has_axes()) region.axes = read_axes(message.axes(), reader.below("axes"));
  if (message.corners_size() != 4) {
    reader.wrong("corners", absl::StrCat("are ", message.corners_size(), ", must be 4"));
    return region;
  }
  for (int i = 0; i < 4; ++i) region.corners[i] = read_skin_point(message.corners(i), reader.below("corners", i));
  return region;
}

simulation::Support read_support(const v1::Support& message, const FieldReader& reader) {
  simulation::Support support;
  switch (message.kind()) {
    case v1::Support::ROLLERS:
      support.kind = simulation::SupportKind::kRollers;
      break;
    case v1::Support::FREE:
      support.kind = simulation::SupportKind::kFree;
      break;
    case v1::Support::ELASTIC:
      support.kind = simulation::SupportKind::kElastic;
      support.stiffness = reader.required(message.has_stiffness_kpa_per_mm(), message.stiffness_kpa_per_mm(),
                                          kPascalPerMetrePerKilopascalPerMillimetre, "stiffness_kpa_per_mm");
      break;
    default:
      support.kind = simulation::SupportKind::kClamped;
  }
  return support;
}

simulation::TissueLayerSpec read_layer(const v1::TissueLayer& message, const FieldReader& reader) {
  simulation::TissueLayerSpec layer;
  layer.name = message.name();
  if (message.name().empty()) reader.missing("name");
  layer.geometry.thickness =
      read_scalar_field(message.thickness_mm(), kMetrePerMillimetre, reader.below("thickness_mm"));
  if (message.has_elements_through()) {
    layer.geometry.elements_through = reader.required_count(true, message.elements_through(), "elements_through");
  }
  layer.material.youngs_modulus = reader.required(message.has_youngs_modulus_kpa(), message.youngs_modulus_kpa(),
                                                  kPascalPerKilopascal, "youngs_modulus_kpa");
  layer.material.poisson_ratio =
      reader.required(message.has_poisson_ratio(), message.poisson_ratio(), 1.0, "poisson_ratio");
  layer.material.density = reader.required(message.has_density_kg_m3(), message.density_kg_m3(), 1.0, "density_kg_m3");
  return layer;
}

}  // namespace

absl::StatusOr<simulation::FaceModelSpec> to_face_model_spec(const v1::ModelSpec& message) {
  FieldViolations violations;
  const FieldReader reader("", violations);
  simulation::FaceModelSpec spec;
  if (message.has_square()) {
    const v1::Square& square = message.square();
    const FieldReader below = reader.below("square");
    spec.region = geometry::SquareSpec{
        below.required(square.has_length_xi_mm(), square.length_xi_mm(), kMetrePerMillimetre, "length_xi_mm"),
        below.required(square.has_length_eta_mm(), square.length_eta_mm(), kMetrePerMillimetre, "length_eta_mm")};
  } else if (message.has_scan_region()) {
    spec.region = read_scan_region(message.scan_region(), reader.below("scan_region"));
  } else {
    reader.wrong("square", "is missing, and so is scan_region: one of them says where the model is");
  }
  spec.n_xi = reader.required_count(message.has_n_xi(), message.n_xi(), "n_xi");
  spec.n_eta = reader.required_count(message.has_n_eta(), message.n_eta(), "n_eta");
  for (int i = 0; i < message.layers_size(); ++i) {
    spec.layers.push_back(read_layer(message.layers(i), reader.below("layers", i)));
  }
  spec.rim = read_support(message.rim(), reader.below("rim"));
  spec.base = read_support(message.base(), reader.below("base"));
  if (!violations.empty()) return violations.to_status();
  return spec;
}

}  // namespace lipofill::server
