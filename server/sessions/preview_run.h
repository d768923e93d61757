#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "core/simulation/preview.h"
#include "server/sessions/frame.h"
#include "server/sessions/session_sink.h"

namespace lipofill::server {

/// The preview of a simulation, if one is asked for: the settled shape of a coarse model, made
/// before the first step. It takes a step at a time, is shown to viewers, and in the end is
/// compared with the result. A change of the plan lets one under way begin anew, and makes one that
/// was shown outdated. For one thread at a time.
///
/// Checked by tests/unit/server/sessions/preview_run_test.cc and
/// tests/unit/server/sessions/session_preview_test.cc.
class PreviewRun {
 public:
  explicit PreviewRun(bool wanted);

  /// Tells what is known of it; nothing when none is asked for.
  const std::optional<PreviewView>& view() const { return view_; }
  /// True as long as it has a step to take.
  bool is_due() const;
  /// Makes the coarse model the first time, then takes a step. A model or a step that cannot be is
  /// its failure, no exception. Returns the time that it took.
  std::chrono::steady_clock::duration advance(const simulation::Simulation& full, uint64_t epoch);
  /// The settled shape, from its last step until it is outdated.
  const std::shared_ptr<const Frame>& frame() const { return frame_; }

  /// @param why  it is not of the plan any more
  void note_changed_plan(const std::string& why);
  /// Measures how far it was from the simulation that has ended; with a result or, when stopped,
  /// without.
  void judge(const simulation::Simulation& full, bool has_result);
  /// Releases its memory: it is of no more use.
  void let_go();

 private:
  void make(const simulation::Simulation& full);
  void take_step(const simulation::Simulation& full, uint64_t epoch);
  void fail(std::string reason);

  std::optional<PreviewView> view_;
  std::unique_ptr<simulation::Preview> coarse_;  ///< while it is under way
  std::shared_ptr<const Frame> frame_;
};

}  // namespace lipofill::server
