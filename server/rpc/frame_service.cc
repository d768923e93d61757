#include "server/rpc/frame_service.h"

#include <grpcpp/impl/codegen/proto_utils.h>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "server/rpc/names.h"
#include "server/rpc/unary.h"
#include "server/store/sqlite_store.h"

namespace lipofill::server {
namespace {

absl::StatusOr<v1::WatchRequest> parse_request(const grpc::ByteBuffer& bytes) {
  grpc::ByteBuffer copy(bytes);
  v1::WatchRequest request;
  if (!grpc::GenericDeserialize<grpc::ProtoBufferReader, v1::WatchRequest>(&copy, &request).ok()) {
    return absl::InvalidArgumentError("the request is no lipofill.v1.WatchRequest");
  }
  if (const absl::Status valid = check_message(request); !valid.ok()) return valid;
  return request;
}

absl::StatusOr<ViewerOptions> to_viewer_options(const v1::WatchRequest& request) {
  constexpr double kMaxInterval = 1e9;
  FieldViolations violations;
  violations.check_range("interval_ms", request.interval_ms(), 0.0, kMaxInterval, "ms");
  if (!violations.empty()) return violations.to_status();
  ViewerOptions options;
  options.delivery = request.delivery() == v1::WatchRequest::EVERY ? Delivery::kEvery : Delivery::kLatest;
  options.meshes.assign(request.meshes().begin(), request.meshes().end());
  options.interval_s = request.interval_ms() * 1e-3;
  options.seen_epoch = request.seen_epoch();
  options.seen_sequence = request.seen_sequence();
  return options;
}

}  // namespace

grpc::ServerWriteReactor<grpc::ByteBuffer>* FrameService::Watch(grpc::CallbackServerContext*,
                                                                const grpc::ByteBuffer* request) {
  std::shared_ptr<WatchStream> stream;
  const absl::Status begun = guarded([&] { return begin(*request, stream); });
  if (!begun.ok()) {
    stream = std::make_shared<WatchStream>(backend_.courier, "");
    stream->begin_failed(begun);
  }
  return stream.get();  // it holds itself until gRPC is done with it
}

absl::Status FrameService::begin(const grpc::ByteBuffer& bytes, std::shared_ptr<WatchStream>& stream) {
  const auto request = parse_request(bytes);
  if (!request.ok()) return request.status();
  const auto id = parse_simulation_name(request->simulation(), "simulation");
  if (!id.ok()) return id.status();
  if (backend_.stopping) return absl::UnavailableError("the daemon is stopping");
  stream = std::make_shared<WatchStream>(backend_.courier, request->known_topology_hash());
  if (const auto session = backend_.sessions.find(*id); session != nullptr) {
    return watch_session(*request, session, stream);
  }
  return watch_kept(*request, *id, stream);
}

absl::Status FrameService::watch_session(const v1::WatchRequest& request, const std::shared_ptr<Session>& session,
                                         const std::shared_ptr<WatchStream>& stream) {
  const auto options = to_viewer_options(request);
  if (!options.ok()) return options.status();
  const std::weak_ptr<WatchStream> target = stream;
  const auto viewer = std::make_shared<Viewer>(*options, [target] {
    if (const auto live = target.lock(); live != nullptr) live->wake();
  });
  stream->begin(viewer, [session, viewer] { session->unwatch(viewer); });
  session->watch(viewer);
  // The daemon may have begun to stop since the caller looked, and gone past this session.
  if (backend_.stopping) viewer->close(absl::UnavailableError("the daemon is stopping"));
  return absl::OkStatus();
}

absl::Status FrameService::watch_kept(const v1::WatchRequest& request, const std::string& id,
                                      const std::shared_ptr<WatchStream>& stream) {
  const auto options = to_viewer_options(request);
  if (!options.ok()) return options.status();
  const auto result = backend_.store.get_result(id);
  if (!result.ok()) return result.status();
  v1::MeshSlice meshes;
  v1::FrameSlice frame;
  if (!meshes.ParseFromString(result->meshes_message) || !frame.ParseFromString(result->frame_message)) {
    return absl::DataLossError(absl::StrCat("the result of ", simulation_name(id), " cannot be read"));
  }
  Topology known;
  for (const std::string& name : mesh_names(meshes)) known.meshes.push_back({name, {}, {}, 3});
  Viewer viewer(*options, [] {});
  if (const absl::Status chosen = viewer.choose_meshes(known); !chosen.ok()) return chosen;
  keep_meshes(viewer.meshes(), *meshes.mutable_arrays());
  keep_meshes(viewer.meshes(), *frame.mutable_fields());
  meshes.set_topology_hash(compute_topology_hash(meshes));
  frame.set_topology_hash(meshes.topology_hash());
  stream->begin_kept(encode_meshes(meshes), encode_frame(frame));
  return absl::OkStatus();
}

}  // namespace lipofill::server
