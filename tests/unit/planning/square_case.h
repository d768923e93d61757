#pragma once

#include <memory>

#include "core/planning/proposal.h"
#include "tests/unit/planning/jaw_case.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::planning {

/// Two zones side by side on a plate of 48 mm.
inline plan::SimulationSpec make_square_plan(double left, double right) {
  plan::SimulationSpec spec = simulation::make_small_plan();
  spec.films[0].n_xi = spec.films[0].n_eta = 12;
  spec.films[0].zones = {{"left", geometry::ChartBox{0.1, 0.45, 0.2, 0.8}},
                         {"right", geometry::ChartBox{0.55, 0.9, 0.2, 0.8}}};
  spec.injections = {{"left", left, 1e-6, std::nullopt, std::nullopt},
                     {"right", right, 1e-6, std::nullopt, std::nullopt}};
  spec.probes.clear();
  spec.goal = plan::TimeGoal::kSettledShape;
  return spec;
}

inline std::shared_ptr<const model::FaceModel> make_square() {
  model::FaceModelSpec spec = simulation::make_small_model_spec();
  spec.n_xi = spec.n_eta = 24;
  return *model::build_face_model(spec, nullptr);
}

inline ProposalRequest make_request(const plan::SimulationSpec& plan) {
  ProposalRequest request;
  request.plan = plan;
  request.min_deficit = 0.2 * kMillimetre;
  request.curve_points = 1;
  request.worthwhile = 0.0;
  return request;
}

/// A target that the plate itself makes of 0.5 and 0.25 mL.
struct SquareCase {
  std::shared_ptr<const model::FaceModel> model = make_square();
  geometry::SurfaceMesh target = make_target(model, make_square_plan(0.5 * kMillilitre, 0.25 * kMillilitre), 0.0, 1);
  ProposalRequest request = make_request(make_square_plan(0.0, 0.0));

  Proposal propose() const {
    auto proposal = propose_plan(model, target, request, nullptr);
    EXPECT_TRUE(proposal.ok()) << proposal.status();
    return *std::move(proposal);
  }
  absl::Status refusal() const { return propose_plan(model, target, request, nullptr).status(); }
};

}  // namespace lipofill::planning
