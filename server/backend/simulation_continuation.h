#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "server/backend/backend.h"
#include "server/sessions/session.h"

namespace lipofill::server {

/// Goes on with a SETTLED simulation by an injection: it runs again, from the state in which it
/// came to rest, with the injection in its log and its plan. That state is found by repeating the
/// run, from its newest checkpoint if it has one, and is known by its hash. Returns the session,
/// held.
///
/// Field violations as Session::inject. FAILED_PRECONDITION where the run does not come to that
/// state again, RESOURCE_EXHAUSTED where there is no room for it, CANCELLED once it is unwanted:
/// the simulation then stays as it is. Null where an equal request did so before.
/// Checked by tests/integration/service/continuation_test.cc.
absl::StatusOr<std::shared_ptr<Session>> continue_simulation(Backend& backend, const std::string& id,
                                                             const InjectionOrder& order, const RequestKey& request,
                                                             const Unwanted& unwanted);

/// The injection that continue_simulation() would add, or why it would not.
absl::StatusOr<plan::InjectionSpec> foresee_continuation(Backend& backend, const std::string& id,
                                                         const InjectionOrder& order, const Unwanted& unwanted);

}  // namespace lipofill::server
