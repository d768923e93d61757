// The preview of a session, made before its first step if one is asked for: the settled shape of a
// coarse model. It takes a step at a time between commands as the session's own steps do, is shown
// to viewers and in the end compared with the result.

#include <exception>

#include "absl/strings/str_cat.h"
#include "server/sessions/session.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {

using simulation::Phase;
using simulation::Preview;

bool Session::preview_is_due() const {
  return view_.preview &&
         (view_.preview->state == PreviewState::kPending || view_.preview->state == PreviewState::kRunning);
}

/// The clock of the simulation stands meanwhile.
void Session::advance_preview() {
  const Clock::time_point begin = Clock::now();
  PreviewView view = *view_.preview;
  try {
    advance_preview(view);
  } catch (const std::exception& error) {
    view.state = PreviewState::kFailed;
    view.reason = error.what();
  }
  const Clock::duration spent = Clock::now() - begin;
  view.wall_s += std::chrono::duration<double>(spent).count();
  running_since_ += spent;
  note_preview(view);
  if (!preview_is_due()) conclude_preview();
}

/// The first time it makes the coarse model, then it takes a step.
void Session::advance_preview(PreviewView& view) {
  if (preview_ != nullptr) {
    preview_->advance_step();
    view.report = preview_->report();
    view.reason = preview_->reason();
    if (preview_->phase() == Phase::kRunning) return;
    view.state = preview_->phase() == Phase::kFailed ? PreviewState::kFailed : PreviewState::kDone;
    if (view.state == PreviewState::kDone) preview_frame_ = make_preview_frame();
    return;
  }
  auto made = Preview::create(simulation_->shared_model(), simulation_->spec());
  if (!made.ok()) {
    view.state = PreviewState::kFailed;
    view.reason = absl::StrCat("the coarse model cannot hold the plan: ", std::string(made.status().message()));
    return;
  }
  preview_ = *std::move(made);
  view.state = PreviewState::kRunning;
  view.n_hexahedra = preview_->n_hexahedra();
  view.n_film_cells = preview_->n_film_cells();
}

std::shared_ptr<const Frame> Session::make_preview_frame() const {
  auto frame = std::make_shared<Frame>();
  frame->epoch = epoch_;
  frame->sequence = simulation_->report().step;
  frame->time_s = preview_->report().time;
  frame->preview = true;
  frame->fields = preview_->frame();
  return frame;
}

void Session::conclude_preview() {
  const PreviewView& view = *view_.preview;
  spdlog::info("simulations/{}: its preview is {} after {} steps in {:.3f} s: {}", options_.id,
               preview_state_name(view.state), view.report.step, view.wall_s, view.reason);
  preview_ = nullptr;
  for (const auto& viewer : viewers_) {
    if (preview_frame_ != nullptr) viewer->offer(preview_frame_);
  }
}

/// A preview under way begins anew; one that was shown is of another plan, and not shown to who comes later.
void Session::note_changed_plan(const std::string& why) {
  if (!view_.preview) return;
  PreviewView view = *view_.preview;
  if (view.state == PreviewState::kRunning) {
    preview_ = nullptr;
    view = PreviewView();
  } else if (view.state == PreviewState::kDone) {
    view.state = PreviewState::kOutdated;
    view.reason = why;
    preview_frame_ = nullptr;
  }
  note_preview(view);
}

/// Measures, once the simulation has ended, how far the preview was from it.
void Session::judge_preview() {
  if (!view_.preview) return;
  PreviewView view = *view_.preview;
  const bool has_result = view_.state == SimulationState::kSettled || view_.state == SimulationState::kFinished;
  if (preview_is_due()) {
    view.state = PreviewState::kFailed;
    view.reason = "the simulation ended before it";
  } else if (view.state == PreviewState::kDone && has_result) {
    view.difference = simulation::compare_preview(preview_frame_->fields, view.report, *simulation_);
  }
  note_preview(view);
}

void Session::note_preview(const PreviewView& preview) {
  const std::lock_guard lock(view_mutex_);
  view_.preview = preview;
}

}  // namespace lipofill::server
