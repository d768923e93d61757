#include "server/simulations/simulation_service.h"

#include <memory>
#include <optional>

#include "absl/strings/str_cat.h"
#include "server/backend/parking.h"
#include "server/backend/plan_check.h"
#include "server/backend/result_reading.h"
#include "server/backend/simulation_creation.h"
#include "server/entry/listing.h"
#include "server/entry/unary.h"
#include "server/simulations/checkpoint_calls.h"
#include "server/simulations/injection_calls.h"
#include "server/simulations/session_replies.h"
#include "server/simulations/shape_stream.h"
#include "server/simulations/timely_look.h"
#include "server/simulations/tissue_deck.h"
#include "server/store/record_names.h"
#include "server/wire/field_mask.h"
#include "server/wire/names.h"
#include "server/wire/request_key.h"

namespace lipofill::server {
namespace {

using Reactor = grpc::ServerUnaryReactor;

}  // namespace

template <typename Request>
Reactor* SimulationService::command(Context* context, const Request* request, v1::Simulation* response,
                                    const char* what, const Act& act, const Amend& amend, const Continue& go_on) {
  Reactor* reactor = context->DefaultReactor();
  bool answered = false;
  const LogScope scope(call_of(context).log_fields());
  const absl::Status done = guarded([&]() -> absl::Status {
    if (const absl::Status valid = check_call(context, *request); !valid.ok()) return valid;
    const auto id = parse_simulation_name(request->name(), "name");
    if (!id.ok()) return id.status();
    if (const absl::Status valid = check_request_id(request->request_id()); !valid.ok()) return valid;
    const RequestKey key = make_request_key(call_of(context).principal, what, request->request_id(), *request);
    const Session::Reply reply = reply_to(backend_, *id, reactor, response, amend);
    // Whether a simulation has settled may be known only once the command's turn has come.
    const auto continue_later = [this, context, id = *id, key, reactor, response, amend, go_on] {
      return backend_.calls.run([this, context, id, key, reactor, response, amend, go_on] {
        const Unwanted unwanted = caller_has_left(context);
        reactor->Finish(to_grpc_status(guarded_if_wanted(unwanted, [&]() -> absl::Status {
          if (absl::Status gone_on = go_on(id, key, unwanted); !gone_on.ok()) return gone_on;
          auto shown = show_simulation(backend_, id);
          if (!shown.ok()) return shown.status();
          *response = *std::move(shown);
          if (amend != nullptr) amend(*response);
          return absl::OkStatus();
        })));
      });
    };
    if (const auto session = backend_.sessions.hold(*id); session != nullptr) {
      answered = true;
      act(*session, key, [this, id = *id, go_on, continue_later, reply](const absl::StatusOr<SessionView>& view) {
        const bool settled = go_on != nullptr && absl::IsFailedPrecondition(view.status()) && has_settled(backend_, id);
        if (!settled) return reply(view);
        if (!continue_later()) reply(too_many_calls(backend_));
      });
      return absl::OkStatus();
    }
    const auto record = backend_.store.get_simulation(*id);
    if (!record.ok()) return record.status();
    if (go_on != nullptr && record->state == SimulationState::kSettled) {
      answered = continue_later();
      return too_many_calls(backend_);
    }
    if (!is_parked(*record)) return answer_without_session(backend_, *record, what, key, *response);
    answered = backend_.calls.run([this, context, id = *id, key, act, reply] {
      wake_and_act(backend_, id, key, act, caller_has_left(context), reply);
    });
    return too_many_calls(backend_);
  });
  if (!answered) reactor->Finish(to_grpc_status(done));
  return reactor;
}

Reactor* SimulationService::CreateSimulation(Context* context, const v1::CreateSimulationRequest* request,
                                             v1::Simulation* response) {
  return answer_later(context, request, backend_, [this, context, request, response] {
    auto simulation = create_simulation(backend_, call_of(context).principal, *request, caller_has_left(context));
    if (simulation.ok()) *response = *std::move(simulation);
    return simulation.status();
  });
}

Reactor* SimulationService::CheckPlan(Context* context, const v1::CheckPlanRequest* request,
                                      v1::CheckPlanResponse* response) {
  return answer_later(context, request, backend_, [this, context, request, response] {
    auto check = check_plan(backend_, *request, caller_has_left(context));
    if (check.ok()) *response = *std::move(check);
    return check.status();
  });
}

Reactor* SimulationService::GetSimulation(Context* context, const v1::GetSimulationRequest* request,
                                          v1::Simulation* response) {
  return answer_or_leave(context, request, [&](Reactor* reactor, bool& is_left) -> absl::Status {
    const auto id = parse_simulation_name(request->name(), "name");
    if (!id.ok()) return id.status();
    const auto& mask = request->read_mask();
    if (auto good = check_field_mask(mask, *v1::Simulation::descriptor(), "read_mask"); !good.ok()) return good;
    if (const auto session = backend_.sessions.find(*id); session != nullptr) {
      is_left = true;
      const auto amend = [mask](v1::Simulation& shown) { apply_field_mask(mask, shown); };
      TimelyLook::begin(backend_.courier, session, reply_to(backend_, *id, reactor, response, amend));
      return absl::OkStatus();
    }
    const auto record = backend_.store.get_simulation(*id);
    if (record.ok()) *response = show_without_session(backend_, *record);
    apply_field_mask(request->read_mask(), *response);
    return record.status();
  });
}

Reactor* SimulationService::ListSimulations(Context* context, const v1::ListSimulationsRequest* request,
                                            v1::ListSimulationsResponse* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto page = parse_page("simulations", request->page_size(), request->page_token());
    if (!page.ok()) return page.status();
    const auto& mask = request->read_mask();
    if (auto good = check_field_mask(mask, *v1::Simulation::descriptor(), "read_mask"); !good.ok()) return good;
    const auto records = backend_.store.list_simulations(call_of(context).principal.scope, one_more(*page));
    if (!records.ok()) return records.status();
    response->set_next_page_token(fill_page("simulations", *page, *records, [&](const SimulationRecord& record) {
      if (record.is_damaged) return add_unreachable(simulation_name(record.id), *response);
      const auto session = backend_.sessions.find(record.id);
      const SessionView view = session != nullptr ? session->cached_view() : SessionView{};
      *response->add_simulations() =
          session != nullptr ? to_simulation(record, &view) : show_without_session(backend_, record);
      apply_field_mask(mask, *response->mutable_simulations()->rbegin());
    }));
    return absl::OkStatus();
  });
}

Reactor* SimulationService::StartSimulation(Context* context, const v1::StartSimulationRequest* request,
                                            v1::Simulation* response) {
  return command(context, request, response, "start", [](Session& session, RequestKey key, Session::Reply reply) {
    session.start(std::move(key), std::move(reply));
  });
}

Reactor* SimulationService::PauseSimulation(Context* context, const v1::PauseSimulationRequest* request,
                                            v1::Simulation* response) {
  return command(context, request, response, "pause", [](Session& session, RequestKey key, Session::Reply reply) {
    session.pause(std::move(key), std::move(reply));
  });
}

Reactor* SimulationService::ResumeSimulation(Context* context, const v1::ResumeSimulationRequest* request,
                                             v1::Simulation* response) {
  return command(context, request, response, "resume", [](Session& session, RequestKey key, Session::Reply reply) {
    session.resume(std::move(key), std::move(reply));
  });
}

Reactor* SimulationService::StopSimulation(Context* context, const v1::StopSimulationRequest* request,
                                           v1::Simulation* response) {
  return command(context, request, response, "stop", [](Session& session, RequestKey key, Session::Reply reply) {
    session.stop("stopped by a client", std::move(key), std::move(reply));
  });
}

Reactor* SimulationService::DeleteSimulation(Context* context, const v1::DeleteSimulationRequest* request,
                                             google::protobuf::Empty*) {
  return answer_or_leave(context, request, [&](Reactor* reactor, bool& is_left) -> absl::Status {
    const auto id = parse_simulation_name(request->name(), "name");
    if (!id.ok()) return id.status();
    if (const auto session = backend_.sessions.hold(*id); session != nullptr) {
      is_left = true;
      session->abandon(
          [this, id = *id, etag = request->etag()] { return delete_simulation_record(backend_, id, etag); },
          [reactor](const absl::StatusOr<SessionView>& view) { reactor->Finish(to_grpc_status(view.status())); });
      return absl::OkStatus();
    }
    // No simulation may be woken meanwhile.
    const std::lock_guard lock(backend_.waking);
    return delete_simulation_record(backend_, *id, request->etag());
  });
}

Reactor* SimulationService::Inject(Context* context, const v1::InjectRequest* request, v1::Simulation* response) {
  const auto foreseen = std::make_shared<std::optional<v1::Injection>>();
  const auto act = [this, request, foreseen](Session& session, RequestKey key, Session::Reply reply) {
    const auto order = read_injection(backend_, session.id(), *request);
    if (!order.ok()) return reply(order.status());
    if (request->validate_only()) return foresee_injection(session, *order, request->injection(), foreseen, reply);
    session.inject(*order, std::move(key), [reply](absl::StatusOr<SessionView> view) {
      if (!view.ok()) return reply(name_injection(view.status()));
      reply(std::move(view));
    });
  };
  const auto amend = [foreseen](v1::Simulation& simulation) {
    if (foreseen->has_value()) *simulation.mutable_spec()->add_injections() = **foreseen;
  };
  const auto go_on = [this, request, foreseen](const std::string& id, const RequestKey& key, const Unwanted& unwanted) {
    return continue_or_foresee(backend_, id, *request, key, unwanted, *foreseen);
  };
  return command(context, request, response, "inject", act, amend, go_on);
}

Reactor* SimulationService::CreateCheckpoint(Context* context, const v1::CreateCheckpointRequest* request,
                                             v1::Checkpoint* response) {
  return answer_later(context, request, backend_, [this, context, request, response] {
    auto checkpoint = create_checkpoint(backend_, call_of(context).principal, *request);
    if (checkpoint.ok()) *response = *std::move(checkpoint);
    return checkpoint.status();
  });
}

Reactor* SimulationService::GetCheckpoint(Context* context, const v1::GetCheckpointRequest* request,
                                          v1::Checkpoint* response) {
  return answer(context, request, [&] { return get_checkpoint(backend_, *request, *response); });
}

Reactor* SimulationService::ListCheckpoints(Context* context, const v1::ListCheckpointsRequest* request,
                                            v1::ListCheckpointsResponse* response) {
  return answer(context, request, [&] { return list_checkpoints(backend_, *request, *response); });
}

Reactor* SimulationService::DeleteCheckpoint(Context* context, const v1::DeleteCheckpointRequest* request,
                                             google::protobuf::Empty*) {
  return answer(context, request, [&] { return delete_checkpoint(backend_, *request); });
}

Reactor* SimulationService::RestoreSimulation(Context* context, const v1::RestoreSimulationRequest* request,
                                              v1::Simulation* response) {
  return answer_later(context, request, backend_, [this, context, request, response] {
    auto simulation = restore_simulation(backend_, call_of(context).principal, *request);
    if (simulation.ok()) *response = *std::move(simulation);
    return simulation.status();
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
  return answer_later(context, request, backend_, [this, context, request, response]() -> absl::Status {
    auto evaluation = evaluate_simulation(backend_, *request, caller_has_left(context));
    if (evaluation.ok()) *response = *std::move(evaluation);
    return evaluation.status();
  });
}

grpc::ServerWriteReactor<v1::ExportTissueDeckResponse>* SimulationService::ExportTissueDeck(
    Context* context, const v1::ExportTissueDeckRequest* request) {
  return export_tissue_deck(backend_, context, *request);
}

grpc::ServerWriteReactor<v1::FindShapeResponse>* SimulationService::FindShape(Context* context,
                                                                              const v1::FindShapeRequest* request) {
  return find_shape(backend_, context, *request);
}

}  // namespace lipofill::server
