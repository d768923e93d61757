#include "server/wire/delivery_conversion.h"

#include "core/base/field_violations.h"
#include "core/base/units.h"

namespace lipofill::server {
namespace {

v1::Vector3 to_vector(const Eigen::Vector3d& position) {
  v1::Vector3 message;
  message.set_x(position.x() * kMillimetresPerMetre);
  message.set_y(position.y() * kMillimetresPerMetre);
  message.set_z(position.z() * kMillimetresPerMetre);
  return message;
}

void set_place(const geometry::ChartPoint& place, v1::ChartPoint& message) {
  message.set_xi(place.xi);
  message.set_eta(place.eta);
}

void set_injection(const plan::InjectionSpec& injection, v1::Injection& message) {
  message.set_zone(injection.zone);
  message.set_volume_ml(injection.volume / kCubicMetresPerMillilitre);
  message.set_rate_ml_per_s(injection.rate / kCubicMetresPerMillilitre);
  set_place(std::get<geometry::ChartPoint>(*injection.site), *message.mutable_site()->mutable_chart());
}

}  // namespace

absl::StatusOr<planning::DeliverySettings> to_delivery_settings(const v1::PlanDeliveryRequest& request) {
  planning::DeliverySettings settings;
  FieldViolations violations;
  if (request.has_max_pass_ml()) {
    violations.check_range("max_pass_ml", request.max_pass_ml(), 0.001, 0.1, "mL");
    settings.max_pass = request.max_pass_ml() * kCubicMetresPerMillilitre;
  }
  if (request.has_tunnel_spacing_mm()) {
    violations.check_range("tunnel_spacing_mm", request.tunnel_spacing_mm(), 2.0, 20.0, "mm");
    settings.tunnel_spacing = request.tunnel_spacing_mm() * kMetresPerMillimetre;
  }
  if (!violations.empty()) return violations.to_status();
  return settings;
}

v1::Delivery to_delivery(const v1::SimulationSpec& plan, const planning::Delivery& delivery) {
  v1::Delivery message;
  for (const planning::CannulaEntry& entry : delivery.entries) {
    v1::CannulaEntry& to = *message.add_entries();
    to.set_zone(entry.zone);
    to.set_below_layer(entry.below_layer);
    *to.mutable_place_mm() = to_vector(entry.position);
    set_place(entry.place, *to.mutable_place());
    to.set_volume_ml(entry.volume / kCubicMetresPerMillilitre);
    to.set_passes(static_cast<uint32_t>(entry.passes));
  }
  for (const planning::CannulaPass& pass : delivery.passes) {
    v1::CannulaPass& to = *message.add_passes();
    to.set_entry(static_cast<uint32_t>(pass.entry));
    to.set_tunnel(static_cast<uint32_t>(pass.tunnel));
    to.set_volume_ml(pass.volume / kCubicMetresPerMillilitre);
    for (Eigen::Index k = 0; k < pass.positions.cols(); ++k) *to.add_path_mm() = to_vector(pass.positions.col(k));
  }
  *message.mutable_plan_as_given() = plan;
  message.mutable_plan_as_given()->clear_injections();
  for (const plan::InjectionSpec& injection : delivery.plan_as_given.injections) {
    set_injection(injection, *message.mutable_plan_as_given()->add_injections());
  }
  message.mutable_plan_as_given()->mutable_time()->set_end_s(delivery.plan_as_given.end);
  message.mutable_remarks()->Add(delivery.remarks.begin(), delivery.remarks.end());
  return message;
}

}  // namespace lipofill::server
