#include "client/cpp/frame_watcher.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <random>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cpp/array_assembler.h"
#include "client/cpp/silence_watch.h"
#include "lipofill/v1/frame_service.grpc.pb.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

/// Puts the messages of one stream together to meshes and frames.
class StreamAssembler {
 public:
  StreamAssembler(v1::WatchRequest& request, const WatchHandlers& handlers) : request_(request), handlers_(handlers) {}

  absl::Status add(const v1::WatchResponse& response) {
    completed_frame_ = false;
    if (response.has_mesh()) return add_mesh(response.mesh());
    if (response.has_frame()) return add_frame(response.frame());
    return absl::OkStatus();
  }

  bool moved() const { return moved_; }
  /// True when the last message ended a frame that is to be acknowledged: all but the last frame
  /// are.
  bool has_frame_to_acknowledge() const { return completed_frame_ && request_.max_unacknowledged_frames() > 0; }

 private:
  absl::Status add_mesh(const v1::MeshSlice& slice) {
    for (const v1::ArraySlice& array : slice.arrays()) {
      if (auto status = mesh_.add(array); !status.ok()) return status;
    }
    if (!slice.last()) return absl::OkStatus();
    auto arrays = mesh_.take();
    if (!arrays.ok()) return arrays.status();
    request_.set_known_topology_hash(slice.topology_hash());
    moved_ = true;
    return handlers_.on_meshes({slice.topology_hash(), *std::move(arrays)});
  }

  absl::Status add_frame(const v1::FrameSlice& slice) {
    for (const v1::ArraySlice& array : slice.fields()) {
      if (auto status = frame_.add(array); !status.ok()) return status;
    }
    if (!slice.last()) return absl::OkStatus();
    auto fields = frame_.take();
    if (!fields.ok()) return fields.status();
    request_.set_seen_epoch(slice.epoch());
    request_.set_seen_sequence(slice.sequence());
    moved_ = true;
    completed_frame_ = !slice.end();
    return handlers_.on_frame({slice.epoch(), slice.sequence(), slice.time_s(), slice.skipped_frames(), slice.end(),
                               *std::move(fields), slice.preview()});
  }

  v1::WatchRequest& request_;  // told what has been seen, for taking up a broken stream
  const WatchHandlers& handlers_;
  ArrayAssembler mesh_;
  ArrayAssembler frame_;
  bool completed_frame_ = false;
  bool moved_ = false;
};

/// Acknowledges the frame. Other failures than its own also end the stream, which then says why; no
/// answer at all is DEADLINE_EXCEEDED.
absl::Status acknowledge(const Connection& connection, const v1::WatchRequest& request,
                         std::chrono::milliseconds limit) {
  v1::AcknowledgeFrameRequest message;
  message.set_simulation(request.simulation());
  message.set_viewer(request.viewer());
  message.set_epoch(request.seen_epoch());
  message.set_sequence(request.seen_sequence());
  const absl::Status status = connection
                                  .call<v1::FrameService>(&v1::FrameService::Stub::AcknowledgeFrame, message,
                                                          std::chrono::ceil<std::chrono::seconds>(limit))
                                  .status();
  const bool counts =
      absl::IsInvalidArgument(status) || absl::IsPermissionDenied(status) || absl::IsDeadlineExceeded(status);
  return counts ? status : absl::OkStatus();
}

std::string make_viewer_name() {
  std::random_device random;
  return absl::StrCat("v", absl::Hex(random(), absl::kZeroPad8), absl::Hex(random(), absl::kZeroPad8));
}

std::chrono::milliseconds silence_limit(const v1::WatchRequest& request) {
  const std::chrono::duration<double, std::milli> heartbeat(request.heartbeat_ms());
  return kSilentHeartbeats *
         (request.has_heartbeat_ms() ? std::chrono::ceil<std::chrono::milliseconds>(heartbeat) : kDefaultHeartbeat);
}

absl::Status silent(const Connection& connection, std::chrono::milliseconds limit) {
  return absl::UnavailableError(absl::StrCat("nothing came from ", connection.server(), " for ",
                                             static_cast<double>(limit.count()) / 1000.0, " s, not even a heartbeat"));
}

/// Outcome of one stream.
struct StreamEnd {
  absl::Status status;
  bool moved = false;          ///< anything whole came
  bool is_wire_error = false;  ///< not an error of the handlers
};

/// Reads one stream to its end.
StreamEnd watch_once(const Connection& connection, v1::WatchRequest& request, const WatchHandlers& handlers) {
  const auto stub = v1::FrameService::NewStub(connection.channel());
  grpc::ClientContext context;
  std::stop_callback cancel(connection.stop(), [&context] { context.TryCancel(); });
  const std::chrono::milliseconds limit = silence_limit(request);
  SilenceWatch silence(limit, [&context] { context.TryCancel(); });
  // Reading changes the request, so the stream is opened with a copy.
  const v1::WatchRequest opened = request;
  const auto reader = stub->Watch(&context, opened);
  StreamAssembler assembler(request, handlers);
  v1::WatchResponse response;
  const auto read = [&] {
    silence.begin_wait();
    const bool came = reader->Read(&response);
    silence.end_wait();
    return came;
  };
  absl::Status handled;
  absl::Status acknowledged;
  while (handled.ok() && acknowledged.ok() && read()) {
    handled = assembler.add(response);
    if (handled.ok() && assembler.has_frame_to_acknowledge()) acknowledged = acknowledge(connection, request, limit);
  }
  if (!handled.ok() || !acknowledged.ok()) context.TryCancel();
  const grpc::Status finished = reader->Finish();
  if (!handled.ok()) return {handled, assembler.moved(), false};
  if (silence.was_silent() || absl::IsDeadlineExceeded(acknowledged)) {
    return {silent(connection, limit), assembler.moved(), true};
  }
  if (!acknowledged.ok()) return {acknowledged, assembler.moved(), false};
  return {status_of(finished, connection.server()), assembler.moved(), !finished.ok()};
}

/// True when the stream can be taken up again; ABORTED does not count, as another has taken this
/// viewer's place.
bool can_resume(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsResourceExhausted(status);
}

/// Waits unless the stop comes first; true when it did.
bool stopped_within(const std::stop_token& stop, std::chrono::milliseconds time) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  return wake.wait_for(lock, stop, time, [&stop] { return stop.stop_requested(); });
}

}  // namespace

absl::Status watch(const Connection& connection, v1::WatchRequest request, const WatchHandlers& handlers) {
  if (request.max_unacknowledged_frames() > 0 && request.viewer().empty()) request.set_viewer(make_viewer_name());
  bool seen_any = false;
  for (int resumes = 0;;) {
    const auto [status, moved, is_wire_error] = watch_once(connection, request, handlers);
    seen_any = seen_any || moved;
    resumes = moved ? 0 : resumes + 1;
    if (status.ok() || !is_wire_error || !can_resume(status) || !seen_any || resumes > kMaxResumes) return status;
    if (handlers.on_resume) handlers.on_resume(status);
    if (stopped_within(connection.stop(), std::chrono::milliseconds(100 * (resumes + 1)))) {
      return absl::CancelledError("interrupted");
    }
  }
}

absl::StatusOr<Meshes> download_model_mesh(const Connection& connection, const std::string& model) {
  const auto stub = v1::PatientService::NewStub(connection.channel());
  grpc::ClientContext context;
  std::stop_callback cancel(connection.stop(), [&context] { context.TryCancel(); });
  v1::DownloadModelMeshRequest request;
  request.set_name(model);
  const auto reader = stub->DownloadModelMesh(&context, request);
  ArrayAssembler assembler;
  Meshes meshes;
  v1::MeshSlice slice;
  absl::Status status;
  while (status.ok() && reader->Read(&slice)) {
    meshes.topology_hash = slice.topology_hash();
    for (int i = 0; status.ok() && i < slice.arrays_size(); ++i) status = assembler.add(slice.arrays(i));
  }
  if (!status.ok()) context.TryCancel();
  const absl::Status finished = status_of(reader->Finish(), connection.server());
  if (!status.ok()) return status;
  if (!finished.ok()) return finished;
  auto arrays = assembler.take();
  if (!arrays.ok()) return arrays.status();
  meshes.arrays = *std::move(arrays);
  return meshes;
}

}  // namespace lipofill::client
