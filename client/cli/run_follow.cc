// The middle of a run: the simulation is started, watched and told about until its frames end.

#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/result_files.h"
#include "client/cli/run.h"
#include "client/cli/scanned_colours.h"
#include "client/cli/simulation_calls.h"
#include "client/cpp/result_text.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::SimulationService;

constexpr std::chrono::milliseconds kFollowPeriod(200);
constexpr std::chrono::seconds kWatchTime(5);
constexpr double kDefaultEndSeconds = 60.0;

}  // namespace

/// Asks for every frame of the interval, or without one for the first and the last.
v1::WatchRequest Run::watch_request() const {
  v1::WatchRequest request;
  request.set_simulation(simulation_.name());
  const double interval_ms = ground_.plan().plan.output().interval_ms();
  request.set_delivery(interval_ms > 0.0 ? v1::WatchRequest::EVERY : v1::WatchRequest::LATEST);
  const v1::TimeControl& time = simulation_.spec().time();
  const double end_ms = 1e3 * (time.has_end_s() ? time.end_s() : kDefaultEndSeconds);
  request.set_interval_ms(interval_ms > 0.0 ? interval_ms : end_ms);
  return request;
}

absl::Status Run::take_frames(const v1::WatchRequest& request, const std::function<void()>& on_watching) {
  WatchHandlers handlers;
  handlers.on_meshes = [this, &on_watching](Meshes meshes) {
    add_scanned_colours(ground_.connection(), simulation_, &meshes.arrays);
    folder_.set_meshes(std::move(meshes.arrays));
    on_watching();
    return absl::OkStatus();
  };
  handlers.on_frame = [this](const Frame& frame) {
    return frame.preview ? folder_.write_preview(frame.fields) : folder_.write_frame(frame.time_s, frame.fields);
  };
  return watch(ground_.connection(), request, handlers);
}

/// Frames are taken and written on a thread of their own, so that the progress goes on while a file
/// is written.
absl::Status Run::simulate() {
  v1::WatchRequest request = watch_request();
  auto meshes = mesh_names(ground_.connection(), simulation_);
  if (!meshes.ok()) return meshes.status();
  request.mutable_meshes()->Assign(meshes->begin(), meshes->end());
  absl::Status frames;
  absl::Status followed;
  std::stop_source ended;
  std::promise<void> watching;
  {
    const std::jthread taker([&] {
      frames = take_frames(request, [&watching, first = true]() mutable {
        if (std::exchange(first, false)) watching.set_value();
      });
      ended.request_stop();
    });
    // The simulation is started only once it is watched, or the first frames would be missed.
    watching.get_future().wait_for(kWatchTime);
    followed = start_and_follow(ended.get_token());
  }
  if (application_.interrupt().requested()) {
    stop_simulation();
    // The state it had reached is worth keeping.
    const Connection last_words = ground_.connection().without_stop();
    if (auto state = get_simulation(last_words, simulation_.name()); state.ok()) simulation_ = *std::move(state);
    (void)fetch_series(last_words, simulation_.name(), &rows_);
    (void)write_figures(folder_.path(), record_.plan, simulation_, rows_);
    (void)write_run_record(folder_.path(), record_);
    return absl::CancelledError("interrupted");
  }
  if (!followed.ok()) return followed;
  return frames;
}

/// Starts the simulation and shows how far it is until all frames have been taken.
absl::Status Run::start_and_follow(const std::stop_token& frames_ended) {
  v1::StartSimulationRequest request;
  request.set_name(simulation_.name());
  const auto started = ground_.connection().call<SimulationService>(&SimulationService::Stub::StartSimulation, request);
  if (!started.ok()) {
    // No frame ever comes without a start: deleting the simulation ends the taker that waits for
    // them.
    v1::DeleteSimulationRequest remove;
    remove.set_name(simulation_.name());
    (void)ground_.connection().without_stop().call<SimulationService>(&SimulationService::Stub::DeleteSimulation,
                                                                      remove);
    return started.status();
  }
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  while (!frames_ended.stop_requested()) {
    // A call that fails here is seen by the taker too, which takes the stream up again or gives up.
    tell_preview();
    if (fetch_series(ground_.connection(), simulation_.name(), &rows_).ok()) show_progress();
    wake.wait_for(lock, frames_ended, kFollowPeriod, [&frames_ended] { return frames_ended.stop_requested(); });
  }
  return absl::OkStatus();
}

/// Tells of the preview once, when it is there or has failed.
void Run::tell_preview() {
  if (preview_told_ || !simulation_.spec().preview()) return;
  const auto simulation = get_simulation(ground_.connection(), simulation_.name());
  if (!simulation.ok()) return;
  const v1::PreviewSummary& preview = simulation->summary().preview();
  if (preview.state() == v1::PreviewSummary::PENDING || preview.state() == v1::PreviewSummary::RUNNING) return;
  progress_.note(absl::StrCat("preview: ", preview_text(preview)));
  preview_told_ = true;
}

void Run::show_progress() {
  if (!rows_.empty()) return progress_.show(progress_text(rows_.back()));
  const auto simulation = get_simulation(ground_.connection(), simulation_.name());
  if (simulation.ok() && simulation->has_recovery()) return progress_.show(simulation->reason());
  if (simulation.ok() && simulation->state() == v1::Simulation::QUEUED) {
    progress_.show(
        absl::StrCat("waits until others have ended, place ", simulation->queue_position(), " in the queue"));
  }
}

void Run::stop_simulation() {
  v1::StopSimulationRequest request;
  request.set_name(simulation_.name());
  // A simulation that has ended meanwhile refuses, which is just as good.
  (void)ground_.connection().without_stop().call<SimulationService>(&SimulationService::Stub::StopSimulation, request,
                                                                    std::chrono::seconds(10));
}

}  // namespace lipofill::client
