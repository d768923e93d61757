#include "server/simulations/session_replies.h"

#include "server/backend/parking.h"
#include "server/backend/simulation_creation.h"
#include "server/entry/unary.h"

namespace lipofill::server {

Session::Reply reply_to(Backend& backend, const std::string& id, grpc::ServerUnaryReactor* reactor,
                        v1::Simulation* response, const std::function<void(v1::Simulation&)>& amend) {
  return [&backend, id, reactor, response, amend](const absl::StatusOr<SessionView>& view) {
    const absl::Status done = guarded([&]() -> absl::Status {
      if (!view.ok()) return view.status();
      const auto record = backend.store.get_simulation(id);
      if (record.ok()) *response = to_simulation(*record, &*view);
      if (record.ok() && amend != nullptr) amend(*response);
      return record.status();
    });
    reactor->Finish(to_grpc_status(done));
  };
}

absl::Status answer_without_session(Backend& backend, const SimulationRecord& record, const char* what,
                                    const RequestKey& key, v1::Simulation& response) {
  const auto earlier = backend.store.find_request(key);
  if (!earlier.ok()) return earlier.status();
  if (!earlier->has_value()) return no_session_for(backend, what, record);
  response = show_without_session(backend, record);
  return absl::OkStatus();
}

void wake_and_act(Backend& backend, const std::string& id, const RequestKey& key, const SessionAct& act,
                  const Unwanted& unwanted, const Session::Reply& reply) {
  absl::StatusOr<std::shared_ptr<Session>> session = nullptr;
  const absl::Status woken = guarded_if_wanted(unwanted, [&] {
    session = find_or_wake(backend, id);
    return session.status();
  });
  if (!woken.ok()) return reply(woken);
  if (*session == nullptr) return reply(absl::UnavailableError("the simulation ended at this moment; try again"));
  act(**session, key, reply);
}

}  // namespace lipofill::server
