#include "server/planning/deficit_measuring.h"

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/planning/deficit.h"
#include "server/backend/scan_reading.h"
#include "server/wire/names.h"
#include "server/wire/rim_width.h"
#include "server/wire/target_conversion.h"

namespace lipofill::server {
namespace {

/// Four bytes a vertex must stay well below the 4 MiB of a message.
constexpr int kMaxVertices = 800'000;

}  // namespace

absl::StatusOr<v1::Deficit> measure_deficit_of(Backend& backend, const v1::MeasureDeficitRequest& request,
                                               const Unwanted& unwanted) {
  FieldViolations violations;
  const auto scan = parse_scan_name(request.scan(), "scan");
  violations.absorb("", scan.status());
  const auto target = parse_scan_name(request.target_scan(), "target_scan");
  violations.absorb("", target.status());
  const auto landmarks = to_landmarks(request.landmarks_mm(), "landmarks_mm");
  violations.absorb("", landmarks.status());
  const double rim_width = read_rim_width(request, violations);
  if (scan.ok() && target.ok() && scan->patient != target->patient) {
    violations.add("target_scan", "is of another patient than scan");
  }
  if (!violations.empty()) return violations.to_status();
  const auto surface = read_scan_surface(backend, scan->patient, scan->id);
  if (!surface.ok()) return surface.status();
  if (surface->n_vertices() > kMaxVertices && !request.figures_only()) {
    return absl::ResourceExhaustedError(absl::StrCat("the scan has ", surface->n_vertices(),
                                                     " vertices, an answer holds the distances of ", kMaxVertices,
                                                     "; ask for figures_only"));
  }
  const auto goal = read_scan_surface(backend, target->patient, target->id);
  if (!goal.ok()) return goal.status();
  const auto deficit = planning::measure_deficit({*surface, *goal, *landmarks, rim_width}, unwanted);
  if (!deficit.ok()) return deficit.status();
  return to_deficit(*deficit, !request.figures_only());
}

}  // namespace lipofill::server
