#include "server/wire/grid_error_conversion.h"

#include <string>

#include "core/base/units.h"

namespace lipofill::server {

v1::GridError to_grid_error(const absl::StatusOr<forecast::GridError>& error) {
  v1::GridError message;
  if (!error.ok()) {
    message.set_reason(std::string(error.status().message()));
    return message;
  }
  message.set_lift_share(error->lift);
  message.set_pressure_share(error->pressure);
  message.set_skin_mm(error->skin * kMillimetresPerMetre);
  if (error->lift_order) message.set_lift_order(*error->lift_order);
  if (error->pressure_order) message.set_pressure_order(*error->pressure_order);
  message.set_order_holds(error->order_holds);
  return message;
}

}  // namespace lipofill::server
