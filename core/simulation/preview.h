#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/simulation/simulation.h"

namespace lipofill::simulation {

/// The difference of a preview from the full result.
struct PreviewDifference {
  double max = 0.0;     ///< skin displacements differ by this at most, over its nodes [m]
  double rms = 0.0;     ///< the same, root of the mean square [m]
  double volume = 0.0;  ///< swept by the skin: preview minus full [m3]
};

/// The settled shape of a plan as a coarser model foresees it, before the plan itself is run: the
/// model and the plan of coarse_plan.h, in long steps (TimeGoal::kSettledShape). It has nothing in
/// common with the simulation of the plan but what both are made from, so that this gives the same
/// bytes with and without it. Deterministic. Not thread-safe.
///
/// Checked by tests/unit/simulation/preview_test.cc.
class Preview {
 public:
  /// Creates a preview. Field violations when the coarse grid cannot hold the plan, for example for
  /// a zone that none of its cells is in.
  static absl::StatusOr<std::unique_ptr<Preview>> create(std::shared_ptr<const model::FaceModel> model,
                                                         const plan::SimulationSpec& spec);

  /// Takes one step, as Simulation::advance_step. Fails when kMostSteps have not settled it.
  void advance_step();
  static constexpr uint64_t kMostSteps = 500;

  Phase phase() const { return phase_; }
  const std::string& reason() const { return reason_; }
  const StepReport& report() const { return coarse_->report(); }
  int n_hexahedra() const { return coarse_->n_hexahedra(); }
  int n_film_cells() const { return coarse_->n_film_cells(); }

  /// The present shape on the meshes of the full model: those fields of Simulation::frame that are
  /// on "skin" and "scan", bilinear between the nodes of the coarse skin.
  std::vector<FrameField> frame() const;

 private:
  Preview(std::shared_ptr<const model::FaceModel> model, std::unique_ptr<Simulation> coarse);

  std::shared_ptr<const model::FaceModel> model_;
  std::unique_ptr<Simulation> coarse_;
  Phase phase_ = Phase::kRunning;
  std::string reason_;
};

/// Compares what a preview foresaw, its frame and its report, with the present shape of the
/// simulation of the plan.
PreviewDifference compare_preview(const std::vector<FrameField>& frame, const StepReport& report,
                                  const Simulation& full);

}  // namespace lipofill::simulation
