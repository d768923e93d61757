#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/backend/backend.h"
#include "server/sessions/session.h"

namespace lipofill::server {

/// Puts the violations of an injection below "injection"; an etag that does not match is not one of
/// its fields.
absl::Status name_injection(const absl::Status& status);

/// The injection of a request, to be refused where the etag it gives is not the simulation's.
absl::StatusOr<InjectionOrder> read_injection(Backend& backend, const std::string& id,
                                              const v1::InjectRequest& request);

/// Finds out what the session would inject.
void foresee_injection(Session& session, const InjectionOrder& order, const v1::Injection& injection,
                       const std::shared_ptr<std::optional<v1::Injection>>& foreseen, const Session::Reply& reply);

/// Goes on with a simulation that has settled (simulation_continuation.h), or only finds out how it
/// would.
absl::Status continue_or_foresee(Backend& backend, const std::string& id, const v1::InjectRequest& request,
                                 const RequestKey& key, const Unwanted& unwanted,
                                 std::optional<v1::Injection>& foreseen);

/// True for a simulation whose record says so.
bool has_settled(Backend& backend, const std::string& id);

}  // namespace lipofill::server
