#include "client/cli/distance_fields.h"

#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

Array field_of(const std::string& mesh, std::span<const float> values) {
  Array field;
  field.name = absl::StrCat(mesh, ".distance");
  field.unit = "mm";
  field.location = ArrayLocation::kPoint;
  field.shape = {values.size()};
  field.bytes.resize(values.size() * sizeof(float));
  std::memcpy(field.bytes.data(), values.data(), field.bytes.size());
  return field;
}

}  // namespace

absl::StatusOr<Array> distance_field(const v1::Evaluation& evaluation, size_t points) {
  std::vector<float> values(points, std::numeric_limits<float>::quiet_NaN());
  if (evaluation.vertices_size() != evaluation.distance_mm_size()) {
    return absl::DataLossError("the evaluation has another number of distances than of points");
  }
  for (int i = 0; i < evaluation.vertices_size(); ++i) {
    if (evaluation.vertices(i) >= points) return absl::DataLossError("the evaluation names a point outside its mesh");
    values[evaluation.vertices(i)] = evaluation.distance_mm(i);
  }
  return field_of(evaluation.mesh(), values);
}

Array distance_field(const v1::Deficit& deficit) {
  return field_of("scan", {deficit.distance_mm().data(), static_cast<size_t>(deficit.distance_mm_size())});
}

}  // namespace lipofill::client
