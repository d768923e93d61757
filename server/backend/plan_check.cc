#include "server/backend/plan_check.h"

#include "core/base/field_violations.h"
#include "core/simulation/plan_check.h"
#include "server/wire/names.h"
#include "server/wire/plan_check_conversion.h"
#include "server/wire/simulation_conversion.h"

namespace lipofill::server {

absl::StatusOr<v1::CheckPlanResponse> check_plan(Backend& backend, const v1::CheckPlanRequest& request,
                                                 const Unwanted& unwanted) {
  if (!request.has_spec()) return field_violation("spec", "is missing");
  if (const auto name = parse_model_name(request.spec().model(), "spec.model"); !name.ok()) return name.status();
  if (absl::Status small = check_size(request.spec(), backend.options.sizes); !small.ok()) return small;
  const auto model = backend.load_model(request.spec().model());
  if (!model.ok()) return model.status();
  if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
  const auto plan = to_simulation_spec(request.spec());
  if (!plan.ok()) return to_check_plan_response({field_violations_of(plan.status()), {}, {}, {}});
  const auto check = simulation::check_plan_on_model(**model, *plan, unwanted);
  if (!check.ok()) return check.status();
  return to_check_plan_response(*check);
}

}  // namespace lipofill::server
