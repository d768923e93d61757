#include "server/backend/size_limits.h"

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"

namespace lipofill::server {
namespace {

absl::Status too_large(const std::string& field, double size, const char* what, int bound) {
  return field_violation(field, absl::StrCat("makes ", size, " ", what, ", this service takes at most ", bound),
                         absl::StatusCode::kResourceExhausted);
}

}  // namespace

absl::Status check_size(const v1::ModelSpec& spec, const SizeLimits& limits) {
  double through = 0.0;
  for (const auto& layer : spec.layers()) through += layer.has_elements_through() ? layer.elements_through() : 1.0;
  const double hexahedra = through * spec.n_xi() * spec.n_eta();
  if (hexahedra <= limits.hexahedra) return absl::OkStatus();
  return too_large("spec.n_xi", hexahedra, "hexahedra", limits.hexahedra);
}

absl::Status check_size(const model::FaceModel& model, const SizeLimits& limits) {
  const int hexahedra = model.geometry.grid.n_hexahedra();
  if (hexahedra <= limits.hexahedra) return absl::OkStatus();
  return too_large("spec.n_xi", hexahedra, "hexahedra", limits.hexahedra);
}

absl::Status check_size(const v1::SimulationSpec& spec, const SizeLimits& limits) {
  double cells = 0.0;
  for (const auto& film : spec.films()) cells += static_cast<double>(film.n_xi()) * film.n_eta();
  if (cells <= limits.film_cells) return absl::OkStatus();
  return too_large("spec.films", cells, "film cells", limits.film_cells);
}

}  // namespace lipofill::server
