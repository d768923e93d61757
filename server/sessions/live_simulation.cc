#include "server/sessions/live_simulation.h"

#include <exception>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/units.h"
#include "server/sessions/identifiers.h"
#include "server/sessions/memory.h"
#include "server/sessions/memory_reserve.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {

using simulation::Phase;

LiveSimulation::LiveSimulation(const SessionOptions& options, std::unique_ptr<simulation::Simulation> simulation,
                               SimulationState state, double wall_s, SessionSink& sink)
    : id_(options.id),
      sink_(sink),
      simulation_(std::move(simulation)),
      epoch_(options.epoch),
      clock_(wall_s),
      preview_(options.preview),
      figures_(*simulation_, state, preview_.view()),
      series_(options.id, sink) {
  figures_.measure(*simulation_, wall_s);
}

// ---- figures

void LiveSimulation::set_state(SimulationState state, std::string reason) {
  figures_.set_state(state, std::move(reason));
  if (simulation_ != nullptr) figures_.measure(*simulation_, clock_.wall_s());
}

SessionView LiveSimulation::measure() {
  if (simulation_ != nullptr) figures_.measure(*simulation_, clock_.wall_s());
  SessionView view = figures_.copy();
  if (simulation_ != nullptr) {
    view.state_hash = simulation_->state_hash();
    view.layers = simulation_->layer_reports();
  }
  view.step_ms_median = figures_.step_ms_median();
  return view;
}

// ---- steps

void LiveSimulation::advance_preview() {
  clock_.leave_out(preview_.advance(*simulation_, epoch_));
  figures_.set_preview(preview_.view());
  if (preview_.is_due()) return;
  const PreviewView& view = *preview_.view();
  spdlog::info("simulations/{}: its preview is {} after {} steps in {:.3f} s: {}", id_, preview_state_name(view.state),
               view.report.step, view.wall_s, view.reason);
  if (preview_.frame() != nullptr) audience_.offer(preview_.frame());
}

void LiveSimulation::advance_step() {
  const RunClock::Time begin = RunClock::Clock::now();
  simulation_->advance_step();
  const std::chrono::duration<double> spent = RunClock::Clock::now() - begin;
  if (simulation_->phase() == Phase::kFailed) return;
  const SeriesEntry row{simulation_->report(), kMillisecondsPerSecond * spent.count()};
  figures_.count_step(row.report.cost, row.wall_ms);
  figures_.measure(*simulation_, clock_.wall_s());
  sink_.stepped(row);
  series_.add(row);
  if (simulation_->phase() == Phase::kRunning) show(false);
}

void LiveSimulation::inject(const simulation::ResolvedInjection& injection) {
  simulation_->inject_resolved(injection);
  note_changed_plan("an injection was added after it");
}

void LiveSimulation::go_back(std::unique_ptr<simulation::Simulation> simulation, double wall_s) {
  simulation_ = std::move(simulation);
  series_.forget(series_.after(0).size());
  clock_.set_back(wall_s);
  figures_.measure(*simulation_, wall_s);
  const auto epoch = sink_.begin_epoch(id_);
  epoch_ = epoch.ok() ? *epoch : epoch_ + 1;
  note_changed_plan("the simulation went back to a checkpoint after it");
  audience_.rewind();
  show(true);
}

void LiveSimulation::note_changed_plan(const std::string& why) {
  preview_.note_changed_plan(why);
  figures_.set_preview(preview_.view());
}

absl::StatusOr<CheckpointRecord> LiveSimulation::keep_checkpoint(CheckpointKind kind, const std::string& id,
                                                                 uint64_t last_command, const RequestKey& request) {
  const SessionView view = measure();
  CheckpointRecord draft;
  draft.simulation = id_;
  draft.id = id;
  draft.kind = kind;
  draft.step = view.report.step;
  draft.time_s = view.report.time;
  draft.wall_s = view.wall_s;
  draft.last_command = last_command;
  draft.state_hash = view.state_hash;
  draft.create_time_us = now_us();
  const std::vector<SeriesEntry> rows = series_.after(0);
  auto kept = sink_.keep_checkpoint(draft, simulation_->snapshot(), rows, request);
  if (kept.ok()) series_.forget(rows.size());
  return kept;
}

// ---- frames

std::shared_ptr<const Topology> LiveSimulation::topology() {
  if (topology_ == nullptr) {
    auto made = std::make_shared<Topology>();
    made->meshes = simulation_->topology();
    topology_ = made;
  }
  return topology_;
}

std::shared_ptr<const Frame> LiveSimulation::make_frame(const std::vector<std::string>& meshes, bool end) const {
  auto frame = std::make_shared<Frame>();
  frame->epoch = epoch_;
  frame->sequence = simulation_->report().step;
  frame->time_s = simulation_->report().time;
  frame->end = end;
  frame->fields = simulation_->frame(meshes);
  return frame;
}

std::shared_ptr<const Frame> LiveSimulation::present_frame(const std::vector<std::string>& meshes) const {
  return last_frame_ != nullptr ? last_frame_ : make_frame(meshes, false);
}

void LiveSimulation::show(bool at_rest) {
  audience_.show(simulation_->report().time, at_rest, [this](const std::set<std::string>& meshes) {
    return make_frame({meshes.begin(), meshes.end()}, false);
  });
}

void LiveSimulation::watch(const std::shared_ptr<Viewer>& viewer) {
  if (!has_frames()) return viewer->close(absl::InternalError("the result of the simulation is lost"));
  const auto meshes = topology();
  if (const absl::Status chosen = viewer->choose_meshes(*meshes); !chosen.ok()) return viewer->close(chosen);
  const auto frame = present_frame(viewer->selection().meshes);
  if (const absl::Status known = viewer->check_fields(frame->field_names()); !known.ok()) return viewer->close(known);
  viewer->show_topology(meshes);
  if (preview_.frame() != nullptr) viewer->offer(preview_.frame());
  viewer->offer(frame);
  if (!frame->end) audience_.join(viewer);
}

void LiveSimulation::capture(const std::vector<std::string>& meshes, const CaptureReply& reply) {
  std::shared_ptr<const Topology> shown;
  std::shared_ptr<const Frame> frame;
  if (!has_frames()) return reply(shown, frame);
  try {
    const MayFail may_fail;
    shown = topology();
    frame = present_frame(meshes);
  } catch (const std::exception& error) {
    spdlog::error("simulations/{}: its fields cannot be taken: {}", id_, error.what());
  }
  reply(shown, frame);
}

// ---- the end

void LiveSimulation::conclude() {
  const SimulationState state = figures_.latest().state;
  preview_.judge(*simulation_, state == SimulationState::kSettled || state == SimulationState::kFinished);
  figures_.set_preview(preview_.view());
  if (state == SimulationState::kSettled) {
    figures_.set_discretisation(simulation::estimate_discretisation_error(*simulation_));
  }
  figures_.show(measure());
  take_last_frame();
  if (const absl::Status kept = keep_result(); !kept.ok()) {
    spdlog::error("simulations/{}: its result is not in the store: {}", id_, kept.ToString());
  }
  audience_.offer(last_frame_);
}

void LiveSimulation::conclude_unkept() {
  take_last_frame();
  audience_.offer(last_frame_);
}

void LiveSimulation::take_last_frame() {
  topology();
  last_frame_ = make_frame({}, true);
}

absl::Status LiveSimulation::keep_result() {
  if (last_frame_ == nullptr) return absl::DataLossError("there is none");
  absl::Status kept = series_.flush();
  if (kept.ok()) kept = sink_.ended(id_, figures_.copy(), *topology_, *last_frame_);
  result_kept_ = kept.ok();
  figures_.set_unkept(kept.ok() ? "" : std::string(kept.message()));
  return kept;
}

absl::Status LiveSimulation::keep_parked() {
  SessionView view = measure();
  const absl::Status kept = sink_.parked(id_, view);
  if (kept.ok()) figures_.show(std::move(view));
  return kept;
}

void LiveSimulation::let_go() {
  audience_.dismiss();
  simulation_ = nullptr;
  preview_.let_go();
  give_memory_back();
}

}  // namespace lipofill::server
