#pragma once

#include <grpcpp/grpcpp.h>

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "core/base/unwanted.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/backend/backend.h"
#include "server/sessions/session.h"
#include "server/wire/request_key.h"

namespace lipofill::server {

// This file says how commands to simulations are answered, whether or not they have a session.

/// An act is what a command has a session do, which then calls `reply`.
using SessionAct = std::function<void(Session& session, RequestKey key, Session::Reply reply)>;

/// Answers with the session's view and the record it belongs to.
/// @param amend  adds to the answer what the store does not hold
Session::Reply reply_to(Backend& backend, const std::string& id, grpc::ServerUnaryReactor* reactor,
                        v1::Simulation* response, const std::function<void(v1::Simulation&)>& amend = nullptr);

/// Answers a command when there is no session: the simulation has ended, perhaps by an equal
/// request, or could not be brought back.
absl::Status answer_without_session(Backend& backend, const SimulationRecord& record, const char* what,
                                    const RequestKey& key, v1::Simulation& response);

/// Brings a parked simulation back and has it act.
void wake_and_act(Backend& backend, const std::string& id, const RequestKey& key, const SessionAct& act,
                  const Unwanted& unwanted, const Session::Reply& reply);

}  // namespace lipofill::server
