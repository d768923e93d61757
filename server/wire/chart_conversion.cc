#include "server/wire/chart_conversion.h"

#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/units.h"

namespace lipofill::server {

int FieldReader::required_count(bool has, uint32_t value, const std::string& field) const {
  if (!has) missing(field);
  if (value > static_cast<uint32_t>(std::numeric_limits<int>::max())) {
    wrong(field, absl::StrCat("is ", value, ", which is too many"));
    return 0;
  }
  return static_cast<int>(value);
}

int FieldReader::count_or_choice(bool has, uint32_t value, const std::string& field) const {
  if (!has) return 0;
  if (value == 0) wrong(field, "is 0, must be at least 1; leave it out to have it chosen");
  return required_count(has, value, field);
}

Eigen::Vector3d read_vector(const v1::Vector3& message, double factor, const FieldReader& reader) {
  return {reader.required(message.has_x(), message.x(), factor, "x"),
          reader.required(message.has_y(), message.y(), factor, "y"),
          reader.required(message.has_z(), message.z(), factor, "z")};
}

geometry::ScalarField read_samples(const v1::FieldSamples& message, double factor, const FieldReader& reader) {
  geometry::ScalarField field;
  field.n_xi = reader.required_count(true, message.n_xi(), "n_xi");
  field.n_eta = reader.required_count(true, message.n_eta(), "n_eta");
  field.values.assign(message.values().begin(), message.values().end());
  for (double& value : field.values) value *= factor;
  if (const absl::Status valid = field.validate(); !valid.ok()) {
    for (const FieldViolation& violation : field_violations_of(valid)) reader.wrong_here(violation.description);
    return geometry::ScalarField::constant(0.0);
  }
  return field;
}

geometry::ScalarField read_scalar_field(const v1::ScalarField& message, double factor, const FieldReader& reader) {
  switch (message.kind_case()) {
    case v1::ScalarField::kConstant:
      return geometry::ScalarField::constant(message.constant() * factor);
    case v1::ScalarField::kSamples:
      return read_samples(message.samples(), factor, reader.below("samples"));
    case v1::ScalarField::KIND_NOT_SET:
      break;
  }
  reader.missing_here();
  return geometry::ScalarField::constant(0.0);
}

geometry::SkinPoint read_skin_point(const v1::SkinPoint& message, const FieldReader& reader) {
  switch (message.place_case()) {
    case v1::SkinPoint::kChart: {
      const FieldReader chart = reader.below("chart");
      return geometry::ChartPoint{chart.required(message.chart().has_xi(), message.chart().xi(), 1.0, "xi"),
                                  chart.required(message.chart().has_eta(), message.chart().eta(), 1.0, "eta")};
    }
    case v1::SkinPoint::kPositionMm:
      return read_vector(message.position_mm(), kMetresPerMillimetre, reader.below("position_mm"));
    case v1::SkinPoint::kLandmarks: {
      const v1::LandmarkPoint& landmarks = message.landmarks();
      geometry::LandmarkPoint point;
      point.weights = {landmarks.weights().begin(), landmarks.weights().end()};
      if (point.weights.empty()) reader.below("landmarks").missing("weights");
      point.left = landmarks.left_mm() * kMetresPerMillimetre;
      point.up = landmarks.up_mm() * kMetresPerMillimetre;
      point.forward = landmarks.forward_mm() * kMetresPerMillimetre;
      return point;
    }
    case v1::SkinPoint::PLACE_NOT_SET:
      break;
  }
  reader.missing_here();
  return geometry::ChartPoint{};
}

}  // namespace lipofill::server
