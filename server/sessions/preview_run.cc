#include "server/sessions/preview_run.h"

#include <chrono>
#include <exception>
#include <utility>

#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

using simulation::Phase;
using Clock = std::chrono::steady_clock;

std::shared_ptr<const Frame> make_frame(const simulation::Preview& coarse, const simulation::Simulation& full,
                                        uint64_t epoch) {
  auto frame = std::make_shared<Frame>();
  frame->epoch = epoch;
  frame->sequence = full.report().step;
  frame->time_s = coarse.report().time;
  frame->preview = true;
  frame->fields = coarse.frame();
  return frame;
}

}  // namespace

PreviewRun::PreviewRun(bool wanted) {
  if (wanted) view_.emplace();
}

bool PreviewRun::is_due() const {
  return view_ && (view_->state == PreviewState::kPending || view_->state == PreviewState::kRunning);
}

Clock::duration PreviewRun::advance(const simulation::Simulation& full, uint64_t epoch) {
  const Clock::time_point begin = Clock::now();
  try {
    coarse_ == nullptr ? make(full) : take_step(full, epoch);
  } catch (const std::exception& error) {
    fail(error.what());
  }
  if (!is_due()) coarse_ = nullptr;
  const Clock::duration spent = Clock::now() - begin;
  view_->wall_s += std::chrono::duration<double>(spent).count();
  return spent;
}

void PreviewRun::make(const simulation::Simulation& full) {
  auto made = simulation::Preview::create(full.shared_model(), full.spec());
  if (!made.ok()) {
    return fail(absl::StrCat("the coarse model cannot hold the plan: ", std::string(made.status().message())));
  }
  coarse_ = *std::move(made);
  view_->state = PreviewState::kRunning;
  view_->n_hexahedra = coarse_->n_hexahedra();
  view_->n_film_cells = coarse_->n_film_cells();
}

void PreviewRun::take_step(const simulation::Simulation& full, uint64_t epoch) {
  coarse_->advance_step();
  view_->report = coarse_->report();
  view_->reason = coarse_->reason();
  if (coarse_->phase() == Phase::kRunning) return;
  if (coarse_->phase() == Phase::kFailed) return fail(coarse_->reason());
  frame_ = make_frame(*coarse_, full, epoch);
  view_->state = PreviewState::kDone;
}

void PreviewRun::fail(std::string reason) {
  view_->state = PreviewState::kFailed;
  view_->reason = std::move(reason);
}

void PreviewRun::note_changed_plan(const std::string& why) {
  if (!view_) return;
  if (view_->state == PreviewState::kRunning) {
    coarse_ = nullptr;
    view_ = PreviewView();
  } else if (view_->state == PreviewState::kDone) {
    view_->state = PreviewState::kOutdated;
    view_->reason = why;
    frame_ = nullptr;
  }
}

void PreviewRun::judge(const simulation::Simulation& full, bool has_result) {
  if (!view_) return;
  if (is_due()) {
    fail("the simulation ended before it");
  } else if (view_->state == PreviewState::kDone && has_result) {
    view_->difference = simulation::compare_preview(frame_->fields, view_->report, full);
  }
}

void PreviewRun::let_go() {
  coarse_ = nullptr;
  frame_ = nullptr;
}

}  // namespace lipofill::server
