#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/geometry/mesh_topology.h"
#include "core/mechanics/step_cost.h"
#include "core/model/face_model.h"
#include "core/plan/injection_schedule.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::simulation {

enum class Phase { kRunning, kSettled, kFinished, kFailed };

struct ZoneReport {
  std::string name;
  double volume = 0.0;         ///< [m3]
  double mean_pressure = 0.0;  ///< [Pa]
  double max_thickness = 0.0;  ///< [m]
};

/// A ligament's springs taken together.
struct LigamentReport {
  std::string name;
  double tension = 0.0;         ///< sum over its points [N]
  double largest_length = 0.0;  ///< distance of the two walls [m]
  int points = 0;
  int broken_points = 0;
};

/// The tissue of a layer, the hexahedra's own volume.
struct LayerReport {
  std::string name;
  double rest_volume = 0.0;  ///< [m3]
  double volume = 0.0;       ///< [m3]
};

/// Figures of the state after a step.
struct StepReport {
  uint64_t step = 0;
  double time = 0.0;            ///< [s]
  double step_size = 0.0;       ///< [s]
  double injected = 0.0;        ///< [m3]
  double film_volume = 0.0;     ///< [m3]
  double gap_volume = 0.0;      ///< [m3]
  double initial_volume = 0.0;  ///< [m3]  pre-wetted content at the start
  double film_volume_relative_error = 0.0;
  double gap_volume_relative_error = 0.0;
  double max_pressure = 0.0;           ///< [Pa]
  double min_pressure = 0.0;           ///< [Pa]
  double mean_pressure = 0.0;          ///< [Pa]  weighted by cell area
  double max_thickness = 0.0;          ///< [m]
  double skin_max_displacement = 0.0;  ///< [m]
  double skin_speed = 0.0;             ///< [m/s]  largest over the nodes of the skin
  double skin_volume_change = 0.0;     ///< [m3]  swept by the skin
  double min_scaled_jacobian = 1.0;    ///< the deformed tissue has it
  int film_iterations = 0;             ///< Picard iterations in this step
  int newton_iterations = 0;
  double void_volume = 0.0;       ///< gap that is neither fat nor closed, at the suction limit [m3]
  double undelivered = 0.0;       ///< what injections owe because there was no more to take out [m3], <= 0
  uint64_t rejected_steps = 0;    ///< tried and taken back since the start
  double error_estimate = 0.0;    ///< local error of the step on positions and thickness [m]
  double settling_error = 0.0;    ///< how far the skin has still to go, by the fall of its speed [m]; may be infinite
  double elastic_energy = 0.0;    ///< [J]
  double kinetic_energy = 0.0;    ///< the tissue has it [J]
  double injection_work = 0.0;    ///< since the start [J]
  double film_dissipation = 0.0;  ///< since the start [J]
  double ligament_tension = 0.0;  ///< sum over all ligaments [N]
  int broken_ligament_points = 0;
  int closed_cells = 0;                 ///< cells that fat has not entered
  std::string way;                      ///< "directly", or "in steps: " and what asks for them
  mechanics::StepCost cost;             ///< the step took it, with tries that were taken back
  std::vector<double> probe_thickness;  ///< [m]
  std::vector<double> probe_pressure;   ///< [Pa]
};

using geometry::MeshTopology;

enum class FieldLocation { kPoint, kCell };

/// One named array of a frame, float32 (n, components).
struct FrameField {
  std::string mesh;  ///< name of a MeshTopology
  std::string name;  ///< for example "displacement"
  std::string unit;  ///< for example "mm"
  FieldLocation location = FieldLocation::kPoint;
  int components = 1;
  std::vector<float> values;
};

/// An injection as a simulation adds it to its plan: with its start, and placed on the films.
struct ResolvedInjection {
  plan::InjectionSpec spec;
  plan::PlacedInjection placed;
};

/// One simulation of one plan on one model: deterministic, on one thread, no I/O. Not thread-safe.
///
/// Checked by tests/unit/simulation/, tests/verification/ and tests/property/.
class Simulation {
 public:
  /// Creates a simulation. INVALID_ARGUMENT with field violations named as in
  /// lipofill.v1.SimulationSpec, values in the units of those names.
  static absl::StatusOr<std::unique_ptr<Simulation>> create(std::shared_ptr<const model::FaceModel> model,
                                                            plan::SimulationSpec spec);
  ~Simulation();

  /// Takes one time step; for a plan whose goal is its settled shape, and that has one whatever the
  /// way there (core/equilibrium/scope.h), the one step to it, also when injections came after it.
  /// Never throws. On failure phase() is kFailed with reason(), and the state stays that before the
  /// step, or is the last shape on the path to the settled one. Does nothing unless phase() is
  /// kRunning.
  void advance_step();

  Phase phase() const;
  const std::string& reason() const;
  const StepReport& report() const;
  std::vector<ZoneReport> zone_reports() const;
  std::vector<LigamentReport> ligament_reports() const;
  /// These say what to know before relying on the figures, a sentence each: the remarks on the
  /// model and on its zones, and once it has ended a scaled Jacobian below 0.2, a pressure above 10
  /// kPa, and tissue whose volume is off by more than 2 %.
  std::vector<std::string> remarks() const;
  /// A report a layer, from the skin inwards; none for a model without layers.
  std::vector<LayerReport> layer_reports() const;

  /// Adds an injection to the plan; without a start it begins now, or after the last one still due.
  /// Field violations named as in lipofill.v1.Injection. A settled simulation goes on with it: its
  /// phase is kRunning again. One that ended in another way does not take it: FAILED_PRECONDITION.
  absl::Status inject(const plan::InjectionSpec& injection);
  /// The injection that inject() would add, or why it would refuse it. Whoever must note an
  /// injection before it takes effect notes this one, and then adds it with inject_resolved(),
  /// which refuses nothing. inject() of its specification, at the same step of an equal simulation,
  /// does the same.
  absl::StatusOr<ResolvedInjection> resolve(const plan::InjectionSpec& injection) const;
  /// @pre  this simulation resolved it, and has neither taken a step nor an injection since
  void inject_resolved(const ResolvedInjection& injection);
  const plan::SimulationSpec& spec() const;
  const model::FaceModel& model() const;
  const std::shared_ptr<const model::FaceModel>& shared_model() const;

  int n_hexahedra() const;
  int n_film_cells() const;
  int n_dofs() const;
  /// Memory that it takes while it runs, without its model: an estimate, within a factor of two for
  /// models of a thousand hexahedra and more [B].
  uint64_t memory_bytes() const;

  /// The meshes at rest: "skin", "scan" (where the model has one), "film/<name>" for each film,
  /// "tissue".
  std::vector<MeshTopology> topology() const;

  /// Fields of the present state on the named meshes (all when empty):
  ///
  ///     skin:   displacement [mm] (3), pressure [Pa] (of the film below, 0 where there is none),
  ///             thickness [mm] (of that film)
  ///     scan:   displacement [mm] (3), pressure [Pa]
  ///     film/x: displacement [mm] (3) at points; thickness [mm], pressure [Pa], velocity [mm/s] (3),
  ///             wet (0 or 1) on cells
  ///     tissue: displacement [mm] (3) at points
  ///
  std::vector<FrameField> frame(const std::vector<std::string>& meshes) const;

  /// Skin and scan of another model of the same chart, moved and coloured by this simulation: the
  /// fields of frame() on "skin" and "scan", displacements bilinear between the nodes of this skin.
  std::vector<FrameField> frame_on(const geometry::FaceGeometry& face) const;

  /// SHA-256 of the state: positions, velocities, volumes, pressures, time; equal for equal runs,
  /// byte for byte.
  std::string state_hash() const;

  /// The whole mutable state as bytes, and back into a simulation created from the same model and
  /// specification: restore + advance_step gives the bytes of advance_step alone. DATA_LOSS for
  /// bytes that are not such a state.
  std::string snapshot() const;
  absl::Status restore(std::string_view snapshot);

 private:
  friend class TrialShape;
  Simulation();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lipofill::simulation
