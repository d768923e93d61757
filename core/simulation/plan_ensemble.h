#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::simulation {

/// The change says what a member differs in from a plan on its model, as multiples.
struct PlanChange {
  Eigen::VectorXd moduli;     ///< of each layer's Young's modulus (n_layers)
  Eigen::VectorXd thickness;  ///< of each layer's thickness (n_layers)
  Eigen::VectorXd volumes;    ///< of each injection's volume (n_injections)
  Eigen::VectorXd kept;       ///< share of what was injected that is there at each time (n_times)
};

/// A settled shape in figures; zones in the order of PlanEnsemble::zones().
struct MemberShape {
  Eigen::Matrix3Xf skin;     ///< displacement [m] (3, nodes_per_level)
  double max_lift = 0.0;     ///< the largest displacement of the skin [m]
  double skin_volume = 0.0;  ///< swept by the skin [m3]
  Eigen::VectorXd pressure;  ///< mean over each zone [Pa] (n_zones)
  Eigen::VectorXd volume;    ///< of the fat in each zone [m3] (n_zones)
};

/// The result tells what came of a member: a shape at each time, or why there is none.
struct MemberResult {
  std::string failure;  ///< empty: it settled at every time
  std::vector<MemberShape> shapes;
};

/// Settled shapes of a plan at several times, with tissue, volumes and retention that differ from
/// member to member. At each time members go on from the nominal shape of that time
/// (equilibrium/ensemble.h); a tissue of another thickness is made once and serves all times.
/// Members depend on themselves and on the plan alone: neither the number of workers nor the batch
/// they are in changes a byte. Not thread-safe itself.
/// Checked by tests/unit/simulation/plan_ensemble_test.cc.
class PlanEnsemble {
 public:
  /// Field violations and FAILED_PRECONDITION as TrialShape::create; FAILED_PRECONDITION where the
  /// nominal shape of a time is not found whole.
  /// @param kept     nominal shares of the volume at each time (n_times)
  /// @param workers  threads that find members, at least 1; fewer where memory asks for it
  static absl::StatusOr<std::unique_ptr<PlanEnsemble>> create(std::shared_ptr<const model::FaceModel> model,
                                                              const plan::SimulationSpec& spec,
                                                              const Eigen::VectorXd& kept, int workers);
  ~PlanEnsemble();

  const std::vector<std::string>& zones() const { return zones_; }
  /// The shapes with every multiple 1.
  const std::vector<MemberShape>& nominal() const { return nominal_; }
  /// Is told how many members are done, on any thread, one at a time; false stops the work.
  using Done = std::function<bool(int members)>;
  /// Finds members. CANCELLED once it is stopped.
  absl::StatusOr<std::vector<MemberResult>> find(const std::vector<PlanChange>& changes, const Done& done);

 private:
  class Worker;

  PlanEnsemble();

  std::vector<std::unique_ptr<Worker>> workers_;
  std::vector<std::string> zones_;
  std::vector<MemberShape> nominal_;
};

}  // namespace lipofill::simulation
