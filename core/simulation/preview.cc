#include "core/simulation/preview.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/units.h"
#include "core/plan/coarse_plan.h"

namespace lipofill::simulation {
namespace {

/// Displacement of the skin in a frame [mm] (3 n).
std::vector<float> find_skin_displacement(const std::vector<FrameField>& fields) {
  for (const FrameField& field : fields) {
    if (field.mesh == "skin" && field.name == "displacement") return field.values;
  }
  return {};
}

}  // namespace

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
  const std::vector<float> foreseen = find_skin_displacement(frame);
  const std::vector<float> found = find_skin_displacement(full.frame({"skin"}));
  PreviewDifference difference;
  double squares = 0.0;
  for (size_t k = 0; k + 2 < std::min(foreseen.size(), found.size()); k += 3) {
    double square = 0.0;
    for (size_t c = k; c < k + 3; ++c) square += std::pow(static_cast<double>(foreseen[c]) - found[c], 2);
    difference.max = std::max(difference.max, std::sqrt(square) * kMetresPerMillimetre);
    squares += square;
  }
  if (!found.empty()) {
    difference.rms = std::sqrt(squares / (static_cast<double>(found.size()) / 3.0)) * kMetresPerMillimetre;
  }
  difference.volume = report.skin_volume_change - full.report().skin_volume_change;
  return difference;
}

}  // namespace lipofill::simulation
