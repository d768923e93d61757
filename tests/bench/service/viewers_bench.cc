#include "tests/bench/service/viewers_bench.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <latch>
#include <string>
#include <thread>

#include "absl/strings/str_cat.h"
#include "lipofill/v1/frame_service.grpc.pb.h"
#include "tests/bench/service/process_figures.h"
#include "tests/bench/service/served_plan.h"

namespace lipofill::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// Reads a stream to its end on a thread of its own.
class Viewer {
 public:
  Viewer(const std::string& server, const v1::WatchRequest& request, std::latch& watching)
      : thread_([this, server, request, &watching] { watch(server, request, watching); }) {}

  void join() { thread_.join(); }
  uint64_t frames() const { return frames_; }
  uint64_t bytes() const { return bytes_; }
  const grpc::Status& status() const { return status_; }

 private:
  void watch(const std::string& server, const v1::WatchRequest& request, std::latch& watching) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    const auto channel = grpc::CreateCustomChannel(server, grpc::InsecureChannelCredentials(), arguments);
    const auto stub = v1::FrameService::NewStub(channel);
    grpc::ClientContext context;
    const auto stream = stub->Watch(&context, request);
    v1::WatchResponse response;
    while (stream->Read(&response)) {
      bytes_ += response.ByteSizeLong();
      if (!response.has_frame() || !response.frame().last()) continue;
      if (frames_++ == 0) watching.count_down();
    }
    if (frames_ == 0) watching.count_down();
    status_ = stream->Finish();
  }

  uint64_t frames_ = 0;
  uint64_t bytes_ = 0;
  grpc::Status status_;
  std::thread thread_;
};

absl::Status check(const std::deque<Viewer>& viewers) {
  for (const Viewer& viewer : viewers) {
    if (!viewer.status().ok()) return absl::UnavailableError("a viewer ended: " + viewer.status().error_message());
    if (viewer.frames() == 0) return absl::DataLossError("a viewer saw no frame");
  }
  return absl::OkStatus();
}

absl::StatusOr<ViewersRow> run_once(ServedPlan& served, const std::string& id, int n_viewers,
                                    const std::vector<std::string>& meshes, double simulated_s) {
  if (const absl::Status made = served.create(id, simulated_s); !made.ok()) return made;
  v1::WatchRequest request;
  request.set_simulation("simulations/" + id);
  request.set_delivery(v1::WatchRequest::LATEST);
  for (const std::string& mesh : meshes) request.add_meshes(mesh);
  std::latch watching(n_viewers);
  std::deque<Viewer> viewers;
  for (int k = 0; k < n_viewers; ++k) viewers.emplace_back(served.connection().server(), request, watching);
  watching.wait();

  const absl::Status started = served.start(id);
  const ProcessFigures before = read_process(served.daemon());
  const Clock::time_point begin = Clock::now();
  // Without a start there is no end either: deleting the simulation ends the streams.
  if (!started.ok()) served.remove(id).IgnoreError();
  const absl::StatusOr<v1::Simulation> end = served.await_end(id);
  ViewersRow row;
  row.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  const ProcessFigures after = read_process(served.daemon());
  for (Viewer& viewer : viewers) viewer.join();
  if (!end.ok()) return end.status();
  if (const absl::Status seen = check(viewers); !seen.ok()) return seen;
  row.viewers = n_viewers;
  row.steps = static_cast<double>(end->summary().steps());
  row.worker_cpu_s = after.cpu_s_of_name("worker") - before.cpu_s_of_name("worker");
  row.transport_cpu_s = after.cpu_s - before.cpu_s - row.worker_cpu_s;
  for (const Viewer& viewer : viewers) {
    row.frames += static_cast<double>(viewer.frames()) / n_viewers;
    row.sent_mb += 1e-6 * static_cast<double>(viewer.bytes());
  }
  return row;
}

}  // namespace

absl::StatusOr<std::vector<ViewersRow>> measure_viewers(const client::PlanFile& plan, const std::vector<int>& viewers,
                                                        const std::vector<std::string>& meshes, double simulated_s,
                                                        int rounds) {
  const auto served = ServedPlan::start(plan, 1);
  if (!served.ok()) return served.status();
  std::vector<std::vector<ViewersRow>> runs(viewers.size());
  for (int round = 0; round < rounds; ++round) {
    for (size_t k = 0; k < viewers.size(); ++k) {
      auto row = run_once(**served, absl::StrCat("round", round, "-", viewers[k]), viewers[k], meshes, simulated_s);
      if (!row.ok()) return row.status();
      runs[k].push_back(*row);
    }
  }
  std::vector<ViewersRow> medians;
  for (std::vector<ViewersRow>& rows : runs) {
    const auto middle = rows.begin() + static_cast<std::ptrdiff_t>(rows.size() / 2);
    std::nth_element(rows.begin(), middle, rows.end(),
                     [](const ViewersRow& a, const ViewersRow& b) { return a.worker_cpu_s < b.worker_cpu_s; });
    medians.push_back(*middle);
  }
  return medians;
}

}  // namespace lipofill::bench
