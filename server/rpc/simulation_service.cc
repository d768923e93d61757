#include "server/rpc/simulation_service.h"

#include "absl/strings/str_cat.h"
#include "server/rpc/listing.h"
#include "server/rpc/names.h"
#include "server/rpc/result_reading.h"
#include "server/rpc/simulation_conversion.h"
#include "server/rpc/simulation_creation.h"
#include "server/rpc/tissue_deck.h"
#include "server/rpc/unary.h"
#include "server/rpc/violation_prefix.h"
#include "server/store/sqlite_store.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

using Reactor = grpc::ServerUnaryReactor;

/// Answers with the session's view and the record it belongs to.
Session::Reply reply_to(Backend& backend, const std::string& id, Reactor* reactor, v1::Simulation* response) {
  return [&backend, id, reactor, response](const absl::StatusOr<SessionView>& view) {
    const absl::Status done = guarded([&]() -> absl::Status {
      if (!view.ok()) return view.status();
      const auto record = backend.store.get_simulation(id);
      if (record.ok()) *response = to_simulation(*record, &*view);
      return record.status();
    });
    reactor->Finish(to_grpc_status(done));
  };
}

absl::Status cannot(const char* what, const SimulationRecord& record) {
  return absl::FailedPreconditionError(
      absl::StrCat("cannot ", what, ": ", simulation_name(record.id), " is ", state_name(record.state)));
}

/// The plan that is kept follows what was injected. The session's lock keeps others from doing the same meanwhile.
absl::Status note_injection(Backend& backend, const std::string& id, const v1::Injection& injection) {
  const auto record = backend.store.get_simulation(id);
  if (!record.ok()) return record.status();
  v1::SimulationSpec spec;
  if (!spec.ParseFromString(record->spec_message)) return absl::DataLossError("the plan cannot be read");
  *spec.add_injections() = injection;
  return backend.store.update_simulation_spec(id, spec.SerializeAsString());
}

absl::Status delete_record(Backend& backend, const std::string& id) {
  backend.sessions.remove(id);
  const absl::Status done = backend.store.delete_simulation(id);
  if (done.ok()) spdlog::info("{} deleted", simulation_name(id));
  return done;
}

}  // namespace

template <typename Request>
Reactor* SimulationService::command(Context* context, const Request* request, v1::Simulation* response,
                                    const char* what, const Act& act) {
  Reactor* reactor = context->DefaultReactor();
  const absl::Status refused = guarded([&]() -> absl::Status {
    if (const absl::Status valid = check_message(*request); !valid.ok()) return valid;
    const auto id = parse_simulation_name(request->name(), "name");
    if (!id.ok()) return id.status();
    if (const auto session = backend_.sessions.find(*id); session != nullptr) {
      act(*session, reply_to(backend_, *id, reactor, response));
      return absl::OkStatus();
    }
    const auto record = backend_.store.get_simulation(*id);
    return record.ok() ? cannot(what, *record) : record.status();
  });
  if (!refused.ok()) reactor->Finish(to_grpc_status(refused));
  return reactor;
}

Reactor* SimulationService::CreateSimulation(Context* context, const v1::CreateSimulationRequest* request,
                                             v1::Simulation* response) {
  return answer_later(context, request, backend_, [this, context, request, response] {
    auto simulation = create_simulation(backend_, *request, [context] { return context->IsCancelled(); });
    if (simulation.ok()) *response = *std::move(simulation);
    return simulation.status();
  });
}

Reactor* SimulationService::GetSimulation(Context* context, const v1::GetSimulationRequest* request,
                                          v1::Simulation* response) {
  const auto id = parse_simulation_name(request->name(), "name");
  const auto session = id.ok() ? backend_.sessions.find(*id) : nullptr;
  if (session != nullptr && check_message(*request).ok()) {
    Reactor* reactor = context->DefaultReactor();
    session->inspect(reply_to(backend_, *id, reactor, response));
    return reactor;
  }
  return answer(context, request, [&]() -> absl::Status {
    if (!id.ok()) return id.status();
    const auto record = backend_.store.get_simulation(*id);
    if (record.ok()) *response = to_simulation(*record, nullptr);
    return record.status();
  });
}

Reactor* SimulationService::ListSimulations(Context* context, const v1::ListSimulationsRequest* request,
                                            v1::ListSimulationsResponse* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto page = parse_page("simulations", request->page_size(), request->page_token());
    if (!page.ok()) return page.status();
    const auto records = backend_.store.list_simulations(one_more(*page));
    if (!records.ok()) return records.status();
    response->set_next_page_token(fill_page("simulations", *page, *records, [&](const SimulationRecord& record) {
      const auto session = backend_.sessions.find(record.id);
      const SessionView view = session != nullptr ? session->cached_view() : SessionView{};
      *response->add_simulations() = to_simulation(record, session != nullptr ? &view : nullptr);
    }));
    return absl::OkStatus();
  });
}

Reactor* SimulationService::StartSimulation(Context* context, const v1::StartSimulationRequest* request,
                                            v1::Simulation* response) {
  return command(context, request, response, "start",
                 [](Session& session, Session::Reply reply) { session.start(std::move(reply)); });
}

Reactor* SimulationService::PauseSimulation(Context* context, const v1::PauseSimulationRequest* request,
                                            v1::Simulation* response) {
  return command(context, request, response, "pause",
                 [](Session& session, Session::Reply reply) { session.pause(std::move(reply)); });
}

Reactor* SimulationService::ResumeSimulation(Context* context, const v1::ResumeSimulationRequest* request,
                                             v1::Simulation* response) {
  return command(context, request, response, "resume",
                 [](Session& session, Session::Reply reply) { session.resume(std::move(reply)); });
}

Reactor* SimulationService::StopSimulation(Context* context, const v1::StopSimulationRequest* request,
                                           v1::Simulation* response) {
  return command(context, request, response, "stop",
                 [](Session& session, Session::Reply reply) { session.stop("stopped by a client", std::move(reply)); });
}

Reactor* SimulationService::DeleteSimulation(Context* context, const v1::DeleteSimulationRequest* request,
                                             google::protobuf::Empty*) {
  const auto id = parse_simulation_name(request->name(), "name");
  const auto session = id.ok() ? backend_.sessions.find(*id) : nullptr;
  if (session != nullptr && check_message(*request).ok()) {
    Reactor* reactor = context->DefaultReactor();
    session->stop("deleted", [this, reactor, id = *id](const absl::StatusOr<SessionView>&) {
      reactor->Finish(to_grpc_status(guarded([&] { return delete_record(backend_, id); })));
    });
    return reactor;
  }
  return answer(context, request, [&] { return id.ok() ? delete_record(backend_, *id) : id.status(); });
}

Reactor* SimulationService::Inject(Context* context, const v1::InjectRequest* request, v1::Simulation* response) {
  return command(context, request, response, "inject", [this, request](Session& session, Session::Reply reply) {
    const auto injection = to_injection_spec(request->injection());
    if (!injection.ok()) return reply(with_prefix("injection", injection.status()));
    session.inject(*injection, [this, request, id = session.id(), reply](absl::StatusOr<SessionView> view) {
      if (!view.ok()) return reply(with_prefix("injection", view.status()));
      if (const absl::Status noted = note_injection(backend_, id, request->injection()); !noted.ok()) {
        spdlog::error("{}: an injection is not in the plan that is kept: {}", simulation_name(id), noted.ToString());
      }
      reply(std::move(view));
    });
  });
}

Reactor* SimulationService::GetSeries(Context* context, const v1::GetSeriesRequest* request,
                                      v1::GetSeriesResponse* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto id = parse_simulation_name(request->name(), "name");
    if (!id.ok()) return id.status();
    return read_series(backend_, *id, request->after_step(), *response);
  });
}

Reactor* SimulationService::EvaluateSimulation(Context* context, const v1::EvaluateSimulationRequest* request,
                                               v1::Evaluation* response) {
  return answer_later(context, request, backend_, [this, request, response]() -> absl::Status {
    auto evaluation = evaluate_simulation(backend_, *request);
    if (evaluation.ok()) *response = *std::move(evaluation);
    return evaluation.status();
  });
}

grpc::ServerWriteReactor<v1::ExportTissueDeckResponse>* SimulationService::ExportTissueDeck(
    Context*, const v1::ExportTissueDeckRequest* request) {
  return export_tissue_deck(backend_, *request);
}

}  // namespace lipofill::server
