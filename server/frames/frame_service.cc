#include "server/frames/frame_service.h"

#include <grpcpp/impl/codegen/proto_utils.h>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "server/backend/parking.h"
#include "server/entry/unary.h"
#include "server/sessions/draining.h"
#include "server/sessions/shortage.h"
#include "server/wire/frame_encoding.h"
#include "server/wire/names.h"

namespace lipofill::server {
namespace {

constexpr double kRetryDelayS = 10.0;

absl::StatusOr<v1::WatchRequest> parse_request(const grpc::ByteBuffer& bytes) {
  grpc::ByteBuffer copy(bytes);
  v1::WatchRequest request;
  if (!grpc::GenericDeserialize<grpc::ProtoBufferReader, v1::WatchRequest>(&copy, &request).ok()) {
    return absl::InvalidArgumentError("the request is no lipofill.v1.WatchRequest");
  }
  return request;
}

void check_rate(const v1::WatchRequest& request, FieldViolations& violations) {
  constexpr double kLeastRate = 1e-3;
  constexpr double kMostRate = 1000.0;
  if (request.max_rate_hz() == 0.0) return;
  violations.check_range("max_rate_hz", request.max_rate_hz(), kLeastRate, kMostRate, "Hz");
  if (request.delivery() == v1::WatchRequest::EVERY) {
    violations.add("max_rate_hz",
                   absl::StrCat("is ", request.max_rate_hz(), " Hz with delivery EVERY, which leaves no ",
                                "frame out; use LATEST, or interval_ms"));
  }
}

void check_acknowledgement(const v1::WatchRequest& request, FieldViolations& violations) {
  constexpr double kMostFrames = 1000.0;
  violations.check_range("max_unacknowledged_frames", request.max_unacknowledged_frames(), 0.0, kMostFrames, "frames");
  if (request.max_unacknowledged_frames() > 0 && request.viewer().empty()) {
    violations.add("viewer", "is empty; a viewer that acknowledges frames needs a name to do so by");
  } else if (!request.viewer().empty()) {
    if (request.max_unacknowledged_frames() == 0) {
      violations.add("viewer", "is given without max_unacknowledged_frames: there is nothing to acknowledge");
    }
    violations.absorb("", id_or_new(request.viewer(), 'v', "viewer").status());
  }
}

Courier::Clock::duration heartbeat_of(const v1::WatchRequest& request) {
  constexpr double kHeartbeatMs = 10'000.0;
  const double period_ms = request.has_heartbeat_ms() ? request.heartbeat_ms() : kHeartbeatMs;
  return std::chrono::ceil<Courier::Clock::duration>(std::chrono::duration<double, std::milli>(period_ms));
}

absl::StatusOr<ViewerOptions> to_viewer_options(const v1::WatchRequest& request, const BackendOptions& bounds) {
  constexpr double kMaxInterval = 1e9;
  FieldViolations violations;
  violations.check_range("interval_ms", request.interval_ms(), 0.0, kMaxInterval, "ms");
  check_rate(request, violations);
  check_field_type(request.field_type(), violations);
  if (request.has_heartbeat_ms()) violations.check_range("heartbeat_ms", request.heartbeat_ms(), 100.0, 3.6e6, "ms");
  check_acknowledgement(request, violations);
  if (!violations.empty()) return violations.to_status();
  ViewerOptions options;
  options.delivery = request.delivery() == v1::WatchRequest::EVERY ? Delivery::kEvery : Delivery::kLatest;
  options.selection.meshes.assign(request.meshes().begin(), request.meshes().end());
  options.selection.fields.assign(request.fields().begin(), request.fields().end());
  options.selection.quantised = request.field_type() == v1::UINT16;
  options.max_rate_hz = request.max_rate_hz();
  options.shares_rate = options.delivery == Delivery::kLatest && !request.has_max_rate_hz();
  options.max_unacknowledged = request.max_unacknowledged_frames();
  options.interval_s = request.interval_ms() * 1e-3;
  options.seen_epoch = request.seen_epoch();
  options.seen_sequence = request.seen_sequence();
  options.max_shown_bytes = bounds.viewer_bytes;
  return options;
}

Courier::Clock::time_point to_steady(Principal::Clock::time_point time) {
  return Courier::Clock::now() + std::chrono::ceil<Courier::Clock::duration>(time - Principal::Clock::now());
}

}  // namespace

grpc::ServerWriteReactor<grpc::ByteBuffer>* FrameService::Watch(grpc::CallbackServerContext* context,
                                                                const grpc::ByteBuffer* request) {
  std::shared_ptr<WatchStream> stream;
  const absl::Status begun = guarded([&] { return begin(context, *request, stream); });
  if (!begun.ok()) {
    stream = std::make_shared<WatchStream>(backend_.courier, backend_.metrics.viewers(), "");
    stream->begin_failed(begun);
  }
  return stream.get();  // it holds itself until gRPC is done with it
}

absl::Status FrameService::begin(grpc::CallbackServerContext* context, const grpc::ByteBuffer& bytes,
                                 std::shared_ptr<WatchStream>& stream) {
  if (const absl::Status& refusal = call_of(context).refusal; !refusal.ok()) return refusal;
  const auto request = parse_request(bytes);
  if (!request.ok()) return request.status();
  if (const absl::Status good = check_call(context, *request); !good.ok()) return good;
  const auto id = parse_simulation_name(request->simulation(), "simulation");
  if (!id.ok()) return id.status();
  std::shared_ptr<void> place = take_place();
  if (place == nullptr) {
    return shortage("TOO_MANY_VIEWERS", kRetryDelayS,
                    absl::StrCat("too many viewers are watching, the bound is ", backend_.options.max_viewers));
  }
  stream = std::make_shared<WatchStream>(backend_.courier, backend_.metrics.viewers(), request->known_topology_hash(),
                                         std::move(place));
  if (const auto& expires = call_of(context).principal.expires) stream->end_at(to_steady(*expires), *expires);
  if (const auto session = backend_.sessions.hold(*id); session != nullptr) {
    return watch_session(*request, session, stream);
  }
  const auto record = backend_.store.get_simulation(*id);
  if (record.ok() && is_parked(*record)) return watch_parked(*request, *id, stream);
  if (record.ok() && !has_ended(record->state)) return no_session_for(backend_, "watch", *record);
  return watch_kept(*request, *id, stream);
}

absl::Status FrameService::watch_parked(const v1::WatchRequest& request, const std::string& id,
                                        const std::shared_ptr<WatchStream>& stream) {
  stream->hold();
  const bool taken = backend_.calls.run([this, request, id, stream] {
    const absl::Status watching = guarded([&]() -> absl::Status {
      if (stream->has_ended()) return absl::OkStatus();  // nobody to be woken for
      const auto session = find_or_wake(backend_, id);
      if (!session.ok()) return session.status();
      return *session != nullptr ? watch_session(request, *session, stream) : watch_kept(request, id, stream);
    });
    if (!watching.ok()) stream->begin_failed(watching);
  });
  if (!taken) stream->begin_failed(too_many_calls(backend_));
  return absl::OkStatus();
}

std::shared_ptr<void> FrameService::take_place() {
  if (++open_streams_ <= backend_.options.max_viewers) return {&open_streams_, [](std::atomic<int>* open) { --*open; }};
  --open_streams_;
  return nullptr;
}

absl::Status FrameService::watch_session(const v1::WatchRequest& request, const std::shared_ptr<Session>& session,
                                         const std::shared_ptr<WatchStream>& stream) {
  const auto options = to_viewer_options(request, backend_.options);
  if (!options.ok()) return options.status();
  const std::weak_ptr<WatchStream> target = stream;
  const auto viewer = std::make_shared<Viewer>(*options, [target] {
    if (const auto live = target.lock(); live != nullptr) live->wake();
  });
  const std::string id = session->id();
  if (!request.viewer().empty()) viewers_.add(id, request.viewer(), viewer);
  backend_.metrics.viewers().count_come();
  const auto leave = [this, viewer, id, name = request.viewer()] {
    viewers_.remove(id, name, viewer);
    backend_.metrics.viewers().count_gone();
  };
  const bool begun = stream->begin(viewer, heartbeat_of(request), [session, viewer, leave] {
    session->unwatch(viewer);
    leave();
  });
  if (!begun) {
    leave();
    return absl::OkStatus();
  }
  session->watch(viewer);
  // The daemon may have begun to stop since the caller looked, and gone past this session.
  if (backend_.stopping) viewer->close(draining());
  return absl::OkStatus();
}

grpc::ServerUnaryReactor* FrameService::AcknowledgeFrame(grpc::CallbackServerContext* context,
                                                         const v1::AcknowledgeFrameRequest* request,
                                                         v1::AcknowledgeFrameResponse*) {
  return answer(context, request, [this, request] {
    const auto id = parse_simulation_name(request->simulation(), "simulation");
    if (!id.ok()) return id.status();
    const auto viewer = viewers_.find(*id, request->viewer());
    if (viewer == nullptr) {
      return absl::NotFoundError(absl::StrCat("no viewer '", request->viewer(), "' watches ", request->simulation()));
    }
    return viewer->acknowledge(request->epoch(), request->sequence());
  });
}

absl::Status FrameService::watch_kept(const v1::WatchRequest& request, const std::string& id,
                                      const std::shared_ptr<WatchStream>& stream) {
  const auto options = to_viewer_options(request, backend_.options);
  if (!options.ok()) return options.status();
  const auto shown = kept_.show(id, *options);
  if (!shown.ok()) return shown.status();
  stream->begin_kept(*shown);
  return absl::OkStatus();
}

}  // namespace lipofill::server
