#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server/sessions/session.h"

namespace lipofill::server {

/// Keeps in memory what a store would.
class MemorySink : public SessionSink {
 public:
  struct Kept {
    CheckpointRecord record;
    std::string snapshot;
    size_t n_rows = 0;
  };

  absl::StatusOr<bool> was_kept(const RequestKey& request) override {
    const std::lock_guard lock(mutex);
    return requests.count(request.id) > 0;
  }
  absl::StatusOr<bool> keep_command(const CommandRecord& command, const RequestKey& request) override {
    const std::lock_guard lock(mutex);
    if (!room.ok()) return room;
    if (requests.count(request.id) > 0) return false;
    if (!request.id.empty()) requests.insert(request.id);
    commands.push_back(command);
    return true;
  }
  absl::StatusOr<bool> keep_injection(const CommandRecord& command, double start_s,
                                      const RequestKey& request) override {
    auto kept = keep_command(command, request);
    if (kept.ok() && *kept) starts.push_back(start_s);
    return kept;
  }
  absl::StatusOr<bool> keep_restore(const CommandRecord& command, SimulationState, const std::string&,
                                    const RequestKey& request) override {
    return keep_command(command, request);
  }
  absl::StatusOr<uint64_t> begin_epoch(const std::string&) override { return ++epoch; }
  absl::StatusOr<CheckpointRecord> keep_checkpoint(const CheckpointRecord& draft, const std::string& snapshot,
                                                   const std::vector<SeriesEntry>& rows, const RequestKey&) override {
    std::this_thread::sleep_for(checkpoint_time);
    const std::lock_guard lock(mutex);
    if (!room.ok()) return room;
    checkpoints.push_back({draft, snapshot, rows.size()});
    for (const SeriesEntry& row : rows) steps.push_back(row.report.step);
    return draft;
  }
  absl::Status append_series(const std::string&, const std::vector<SeriesEntry>& rows) override {
    const std::lock_guard lock(mutex);
    if (!room.ok()) return room;
    for (const SeriesEntry& row : rows) steps.push_back(row.report.step);
    return absl::OkStatus();
  }
  absl::Status parked(const std::string& id, const SessionView& view) override {
    const std::lock_guard lock(mutex);
    if (!room.ok()) return room;
    views[id] = view;
    return absl::OkStatus();
  }
  absl::Status ended(const std::string& id, const SessionView& view, const Topology&, const Frame& frame) override {
    const std::lock_guard lock(mutex);
    if (!room.ok()) return room;
    views[id] = view;
    EXPECT_TRUE(frame.end);
    return absl::OkStatus();
  }

  std::mutex mutex;
  absl::Status room;                             ///< what keeping anything says
  std::chrono::milliseconds checkpoint_time{0};  ///< what it takes to keep one
  uint64_t epoch = 100;
  std::set<std::string> requests;
  std::vector<CommandRecord> commands;
  std::vector<double> starts;
  std::vector<Kept> checkpoints;
  std::vector<uint64_t> steps;
  std::map<std::string, SessionView> views;
};

/// A film with a wall of its own: steps of microseconds.
inline std::unique_ptr<simulation::Simulation> make_simulation(double end_s) {
  model::FaceModelSpec face;
  face.region = geometry::SquareSpec{0.04, 0.04};
  face.n_xi = face.n_eta = 4;
  const auto model = model::build_face_model(face, [](double, const char*) { return true; });
  EXPECT_TRUE(model.ok()) << model.status();
  plan::SimulationSpec spec;
  plan::FilmSpec film;
  film.name = "plane";
  film.n_xi = film.n_eta = 3;
  film.zones = {{"all", geometry::ChartBox{}}};
  film.wall = plan::FilmWallKind::kWinkler;
  film.wall_stiffness = 1e7;
  spec.films = {film};
  spec.injections = {{"all", 1e-7, 1e-6, 0.0, std::nullopt}};
  spec.settle_skin_speed = 0.0;
  spec.end = end_s;
  auto made = simulation::Simulation::create(*model, spec);
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

class SessionTest : public ::testing::Test {
 protected:
  static SessionOptions options(const std::string& id, bool real_time = false) {
    SessionOptions options;
    options.id = id;
    options.epoch = 7;
    options.real_time = real_time;
    return options;
  }
  std::shared_ptr<Session> session(const std::string& id, double end_s, bool real_time = false) {
    return std::make_shared<Session>(options(id, real_time), make_simulation(end_s), workers_, sink_);
  }
  /// Gives a command and waits for its answer.
  template <typename Answer = SessionView, typename Command>
  absl::StatusOr<Answer> ask(Command&& command) {
    auto answer = std::make_shared<std::promise<absl::StatusOr<Answer>>>();
    command([answer](absl::StatusOr<Answer> given) { answer->set_value(std::move(given)); });
    return answer->get_future().get();
  }
  absl::StatusOr<SessionView> start(Session& s) {
    return ask([&s](auto reply) { s.start({}, reply); });
  }
  absl::StatusOr<SessionView> pause(Session& s) {
    return ask([&s](auto reply) { s.pause({}, reply); });
  }
  absl::StatusOr<SessionView> inspect(Session& s) {
    return ask([&s](auto reply) { s.inspect(reply); });
  }
  void await_end(const Session& s) {
    while (!has_ended(s.cached_view().state)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  MemorySink sink_;
  WorkerPool workers_{2};
};

}  // namespace lipofill::server
