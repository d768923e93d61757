#include "server/planning/delivery_calls.h"

#include <utility>

#include "core/base/field_violations.h"
#include "core/planning/delivery.h"
#include "server/backend/size_limits.h"
#include "server/wire/delivery_conversion.h"
#include "server/wire/names.h"
#include "server/wire/report_conversion.h"
#include "server/wire/simulation_conversion.h"
#include "server/wire/violation_prefix.h"

namespace lipofill::server {

absl::StatusOr<v1::Delivery> plan_delivery(Backend& backend, const v1::PlanDeliveryRequest& request,
                                           const Unwanted& unwanted) {
  if (!request.has_plan()) return field_violation("plan", "is missing");
  const auto settings = to_delivery_settings(request);
  if (!settings.ok()) return settings.status();
  if (const auto name = parse_model_name(request.plan().model(), "plan.model"); !name.ok()) return name.status();
  if (absl::Status small = check_size(request.plan(), backend.options.sizes); !small.ok()) return small;
  const auto model = backend.load_model(request.plan().model());
  if (!model.ok()) return model.status();
  auto plan = to_simulation_spec(request.plan());
  if (!plan.ok()) return with_prefix("plan", plan.status());
  if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
  const auto delivery = planning::make_delivery(**model, *plan, *settings);
  if (!delivery.ok()) return with_prefix("plan", delivery.status());
  v1::Delivery message = to_delivery(request.plan(), *delivery);
  if (!request.compare()) return message;
  const auto difference = planning::compare_settled(*model, *plan, *delivery, unwanted);
  if (!difference.ok()) return with_prefix("plan", difference.status());
  *message.mutable_difference() = to_distance_statistics(*difference);
  return message;
}

}  // namespace lipofill::server
