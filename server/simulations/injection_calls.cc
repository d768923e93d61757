#include "server/simulations/injection_calls.h"

#include "server/backend/simulation_continuation.h"
#include "server/wire/etag.h"
#include "server/wire/simulation_conversion.h"
#include "server/wire/violation_prefix.h"

namespace lipofill::server {

absl::Status name_injection(const absl::Status& status) {
  return absl::IsAborted(status) ? status : with_prefix("injection", status);
}

absl::StatusOr<InjectionOrder> read_injection(Backend& backend, const std::string& id,
                                              const v1::InjectRequest& request) {
  const auto injection = to_injection_spec(request.injection());
  if (!injection.ok()) return name_injection(injection.status());
  const auto check = [&backend, id, etag = request.etag()]() -> absl::Status {
    if (etag.empty()) return absl::OkStatus();
    const auto record = backend.store.get_simulation(id);
    return record.ok() ? check_etag(etag, make_etag(*record), "etag") : record.status();
  };
  return InjectionOrder{*injection, request.injection().SerializeAsString(), check};
}

void foresee_injection(Session& session, const InjectionOrder& order, const v1::Injection& injection,
                       const std::shared_ptr<std::optional<v1::Injection>>& foreseen, const Session::Reply& reply) {
  session.foresee(order, [&session, injection, foreseen, reply](const absl::StatusOr<plan::InjectionSpec>& spec) {
    if (!spec.ok()) return reply(name_injection(spec.status()));
    *foreseen = injection;
    (*foreseen)->set_start_s(spec->start.value_or(0.0));
    reply(session.cached_view());
  });
}

absl::Status continue_or_foresee(Backend& backend, const std::string& id, const v1::InjectRequest& request,
                                 const RequestKey& key, const Unwanted& unwanted,
                                 std::optional<v1::Injection>& foreseen) {
  const auto order = read_injection(backend, id, request);
  if (!order.ok()) return order.status();
  if (!request.validate_only()) {
    return name_injection(continue_simulation(backend, id, *order, key, unwanted).status());
  }
  const auto spec = foresee_continuation(backend, id, *order, unwanted);
  if (!spec.ok()) return name_injection(spec.status());
  foreseen = request.injection();
  foreseen->set_start_s(spec->start.value_or(0.0));
  return absl::OkStatus();
}

bool has_settled(Backend& backend, const std::string& id) {
  const auto record = backend.store.get_simulation(id);
  return record.ok() && record->state == SimulationState::kSettled;
}

}  // namespace lipofill::server
