#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/face_geometry.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"
#include "core/planning/proposal_bounds.h"
#include "core/planning/proposal_case.h"
#include "core/planning/proposal_remainder.h"
#include "core/planning/robust.h"
#include "core/planning/tradeoff.h"
#include "core/planning/zones_from_deficit.h"

namespace lipofill::planning {

/// A request says what to reach, with what, within which bounds; lipofill.v1.ProposalSpec in SI.
struct ProposalRequest {
  plan::SimulationSpec plan;  ///< its zones are sought; it may have no film where zones are proposed
  ProposalBounds bounds;
  std::optional<ZoneProposals> zones;  ///< that may be added
  double min_deficit = 1e-3;           ///< skin that lacks at least so much is what figures are of [m]
  double worthwhile = 0.05e-3;         ///< a zone that brings less rms is left out [m]
  int curve_points = 5;
  int max_solves = 200;
  std::optional<TissueSpread> spread;  ///< that the plan has to hold for
};

/// This is what goes into one zone.
struct ProposedVolume {
  std::string zone;
  std::string below_layer;
  double volume = 0.0;          ///< [m3]
  double pressure = 0.0;        ///< [Pa]
  double standard_error = 0.0;  ///< for a target off by 0.4 mm at every vertex [m3]
  Bound bound = Bound::kNone;
  bool is_proposed = false;  ///< the zone was not in the plan
};

/// A plan that brings the skin near its target, and how near.
struct Proposal {
  plan::SimulationSpec plan;
  std::vector<ProposedVolume> volumes;
  Closeness before;
  Closeness reached;
  std::vector<Remainder> remainders;
  double max_lift = 0.0;  ///< [m]
  std::vector<TradeOff> curve;
  size_t proposed_point = 0;  ///< of the curve
  ProposalCost cost;
  std::string state_hash;  ///< of a simulation of the plan
  std::vector<std::string> remarks;
  std::optional<Robustness> robustness;  ///< where the request has a spread
  double nominal_rms = 0.0;              ///< of Robustness::nominal, over the skin that lacks something [m]

  double total() const;         ///< [m3]
  double max_pressure() const;  ///< [Pa]
};

/// Proposes a plan: of the choices of zones (zones_from_deficit.h), each with the volumes that are
/// best for it (proposal_fit.h), the one that comes nearest on a coarse model of the face
/// (plan/coarse_plan.h), with the volumes that are best on the face itself and without the zones
/// that bring too little there; then the curve around it. Deterministic: the same request has the
/// same plan, byte for byte, and the hash of its shape.
///
/// INVALID_ARGUMENT with field violations named as in lipofill.v1.ProposalSpec ("plan.films[0]...",
/// "bounds.max_total_ml", "zones.below_layers[1]"); FAILED_PRECONDITION, with figures, where
/// nothing is missing, zones do not reach what is, bounds admit nothing, or the plan has to be
/// stepped; CANCELLED. Checked by tests/unit/planning/proposal_test.cc.
absl::StatusOr<Proposal> propose_plan(std::shared_ptr<const model::FaceModel> model,
                                      const geometry::SurfaceMesh& target, const ProposalRequest& request,
                                      const geometry::Progress& progress);

}  // namespace lipofill::planning
