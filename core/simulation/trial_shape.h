#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/equilibrium/equilibrium.h"
#include "core/mechanics/simulation_state.h"
#include "core/simulation/simulation.h"

namespace lipofill::simulation {

/// Volumes to try a plan with.
struct TrialVolumes {
  /// The volume of an injection in place of the plan's.
  struct Replaced {
    size_t injection = 0;  ///< index in SimulationSpec::injections
    double volume = 0.0;   ///< [m3]
  };
  /// Fat in a zone beyond what the plan puts there.
  struct Added {
    std::string zone;
    double volume = 0.0;  ///< [m3]
  };
  std::vector<Replaced> injections;
  std::vector<Added> added;
};

/// Fat at rest that is connected.
struct PoolReport {
  std::string zones;    ///< joined by " + "
  double volume = 0.0;  ///< [m3]
  double head = 0.0;    ///< pressure at the origin of coordinates [Pa]
};

/// Tells whether the fat of a zone is part of a pool.
bool has_zone(const PoolReport& pool, const std::string& zone);

enum class ShapeParameter { kPoolVolume, kLayerModulus, kLayerThickness };

/// A sensitivity tells what one more unit of a parameter does to a shape, to first order: of a
/// pool's volume [1/m3], or of the logarithm of a layer's Young's modulus or thickness [1].
struct ShapeSensitivity {
  ShapeParameter parameter = ShapeParameter::kPoolVolume;
  std::string name;                   ///< of the pool, as PoolReport::zones, or of the layer
  Eigen::Matrix3Xd skin;              ///< displacement [m] (3, nodes_per_level)
  double skin_volume = 0.0;           ///< swept by the skin [m3]
  std::vector<double> pool_pressure;  ///< [Pa]
};

/// The settled shape of a plan with volumes that change, found directly (core/equilibrium) as often
/// as somebody asks. The plan itself stays as it is. Not thread-safe.
/// Checked by tests/unit/simulation/trial_shape_test.cc.
class TrialShape {
 public:
  /// Field violations as Simulation::create. FAILED_PRECONDITION for a plan that has to be stepped;
  /// it names the field that asks for it.
  static absl::StatusOr<std::unique_ptr<TrialShape>> create(std::shared_ptr<const model::FaceModel> model,
                                                            plan::SimulationSpec spec);
  ~TrialShape();

  /// Finds the shape with these volumes: from rest, so that it depends on them and the plan alone,
  /// or from the last shape, at a fraction of the cost and with some 0.001 mm that depend on the
  /// way. Where not all of the fat goes in, it is the last shape on the way, share() is below 1 and
  /// reason() says what it came to.
  ///
  /// Field violations named as in lipofill.v1.FindShapeRequest. FAILED_PRECONDITION where more is
  /// taken out than there is, or no shape was found at all. The last shape then stays.
  absl::Status find(const TrialVolumes& volumes, bool from_last);

  /// The shape that was found, with its report, zones, remarks and frames.
  const Simulation& shape() const { return *simulation_; }
  double share() const { return share_; }
  const std::string& reason() const { return reason_; }
  bool is_from_rest() const { return is_from_rest_; }
  std::vector<PoolReport> pools() const { return pools_; }
  /// Finds those by each pool's volume, then by each layer's modulus, then by each layer's
  /// thickness; none where the share is below 1. A parameter whose answer is not found is left out.
  std::vector<ShapeSensitivity> find_sensitivities();
  /// Finds those by the volume of each of the plan's injections, in their order, from those of the
  /// pools that it goes into; an injection whose answer is not found has none. Empty where the
  /// share is below 1. The pressures are those of the pools, as everywhere.
  std::vector<std::optional<ShapeSensitivity>> find_injection_sensitivities();
  /// Pressures of the zones, the mean over each as in the zone reports, where the layers' moduli
  /// are these times those of the model and the volumes those of the last shape [Pa] (zones,
  /// members). A member that the tissue does not hold has infinite pressures. The last shape is
  /// then from rest. INVALID_ARGUMENT for moduli out of their bounds, CANCELLED once it is
  /// unwanted.
  absl::StatusOr<Eigen::MatrixXd> find_member_pressures(const std::vector<Eigen::VectorXd>& moduli,
                                                        const Unwanted& unwanted);
  /// Its nodes have moved by this [m] (3, nodes_per_level).
  Eigen::Matrix3Xd skin_displacement() const;

 private:
  explicit TrialShape(std::unique_ptr<Simulation> simulation);
  absl::StatusOr<plan::InjectionSchedule> schedule_with(const TrialVolumes& volumes) const;
  struct ThickerTissue;
  void make_thicker_tissues();
  std::optional<ThickerTissue> make_thicker_tissue(int layer) const;
  Eigen::VectorXd pool_shares(size_t injection) const;
  ShapeSensitivity describe(ShapeParameter parameter, const std::string& name,
                            const equilibrium::Sensitivity& found) const;

  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<const mechanics::SimulationState> rest_;  ///< that the plan begins with
  double share_ = 0.0;
  std::string reason_;
  bool is_from_rest_ = false;
  std::vector<PoolReport> pools_;
  std::vector<Eigen::VectorXd> injected_;  ///< by the last find(), a film [m3]
  std::vector<ThickerTissue> thicker_;     ///< made when thickness is asked about first, and kept
};

}  // namespace lipofill::simulation
