#include "core/simulation/preview.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/units.h"
#include "core/plan/coarse_plan.h"
#include "core/simulation/skin_difference.h"

namespace lipofill::simulation {
Preview::Preview(std::shared_ptr<const model::FaceModel> model, std::unique_ptr<Simulation> coarse)
    : model_(std::move(model)), coarse_(std::move(coarse)) {}

absl::StatusOr<std::unique_ptr<Preview>> Preview::create(std::shared_ptr<const model::FaceModel> model,
                                                         const plan::SimulationSpec& spec) {
  const std::shared_ptr<const model::FaceModel> coarse_model = plan::coarsen_model(*model);
  auto coarse = Simulation::create(coarse_model, plan::coarsen_plan(spec, *model, *coarse_model));
  if (!coarse.ok()) return coarse.status();
  return std::unique_ptr<Preview>(new Preview(std::move(model), *std::move(coarse)));
}

void Preview::advance_step() {
  if (phase_ != Phase::kRunning) return;
  coarse_->advance_step();
  phase_ = coarse_->phase();
  reason_ = coarse_->reason();
  if (phase_ != Phase::kRunning || coarse_->report().step < kMostSteps) return;
  phase_ = Phase::kFailed;
  reason_ = absl::StrCat("the coarse model was not at rest after ", kMostSteps, " steps");
}

std::vector<FrameField> Preview::frame() const {
  return coarse_->frame_on(model_->geometry);
}

PreviewDifference compare_preview(const std::vector<FrameField>& frame, const StepReport& report,
                                  const Simulation& full) {
  PreviewDifference difference;
  double sum = 0.0;
  const std::vector<double> squares = squared_skin_distances(frame, full.frame({"skin"}));
  for (const double square : squares) {
    difference.max = std::max(difference.max, std::sqrt(square) * kMetresPerMillimetre);
    sum += square;
  }
  if (!squares.empty()) {
    difference.rms = std::sqrt(sum / static_cast<double>(squares.size())) * kMetresPerMillimetre;
  }
  difference.volume = report.skin_volume_change - full.report().skin_volume_change;
  return difference;
}

}  // namespace lipofill::simulation
