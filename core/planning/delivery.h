#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/geometry/surface_distance.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::planning {

/// The settings say how fat is laid; lipofill.v1.PlanDeliveryRequest in SI.
struct DeliverySettings {
  double max_pass = 0.1e-6;      ///< one pass lays at most this [m3]
  double tunnel_spacing = 5e-3;  ///< between the far ends of neighbouring tunnels [m]
};

/// The entry is where the cannula goes in.
struct CannulaEntry {
  std::string zone;
  std::string below_layer;
  geometry::ChartPoint place;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< on the skin [m]
  double volume = 0.0;                                 ///< through it [m3]
  int passes = 0;
};

/// Fat laid while the cannula is drawn back along a tunnel.
struct CannulaPass {
  int entry = 0;
  int tunnel = 0;                          ///< of the entry's fan
  double volume = 0.0;                     ///< [m3]
  std::vector<geometry::ChartPoint> path;  ///< places fat is laid at, then the entry
  Eigen::Matrix3Xd positions;              ///< of the path, on the skin [m]
};

/// An injection list.
struct Delivery {
  std::vector<CannulaEntry> entries;
  std::vector<CannulaPass> passes;  ///< in the order in which they are made
  plan::SimulationSpec plan_as_given;
  std::vector<std::string> remarks;
};

/// Makes an injection list of a plan's volumes. Each zone has one entry, 8 mm beyond the lower end
/// of its length, from which a fan of tunnels covers it: every cell of the zone belongs to the
/// tunnel that passes nearest, and gets what its area is of the zone. Tunnels are worked one after
/// the other from one side, each in as many equal passes as keep them at `max_pass`; deep planes
/// come first. The plan as given has an injection for each place of each pass, at its site, in
/// order; together they are the plan's volumes to the last digit but one.
///
/// INVALID_ARGUMENT with field violations as place_plan(); FAILED_PRECONDITION for plans that take
/// fat out, inject none, or need more than a plan's thousand injections.
/// Checked by tests/unit/planning/delivery_test.cc.
absl::StatusOr<Delivery> make_delivery(const model::FaceModel& model, const plan::SimulationSpec& plan,
                                       const DeliverySettings& settings);

/// Tells how far the skin of the plan as given lies from that of the plan, at the nodes, both at
/// rest or at their end: found directly, or in steps where the plan asks for them, which fat with a
/// yield stress does. Errors of Simulation::create; FAILED_PRECONDITION for one that fails;
/// CANCELLED.
absl::StatusOr<geometry::DistanceStatistics> compare_delivery(std::shared_ptr<const model::FaceModel> model,
                                                              const plan::SimulationSpec& plan,
                                                              const Delivery& delivery, const Unwanted& unwanted);

/// The same of the settled shapes, found directly. FAILED_PRECONDITION, naming the field, for a
/// plan that has to be stepped.
absl::StatusOr<geometry::DistanceStatistics> compare_settled(std::shared_ptr<const model::FaceModel> model,
                                                             plan::SimulationSpec plan, const Delivery& delivery,
                                                             const Unwanted& unwanted);

}  // namespace lipofill::planning
