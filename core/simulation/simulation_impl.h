#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/mechanics/simulation_state.h"
#include "core/plan/film_layout.h"
#include "core/plan/injection_schedule.h"
#include "core/plan/plan_placement.h"
#include "core/simulation/direct_shape.h"
#include "core/simulation/frame_layout.h"
#include "core/simulation/simulation.h"
#include "core/step/coupled_step.h"

namespace lipofill::simulation {

/// The members of Simulation; its functions are spread over simulation.cc (steps), step_report.cc,
/// frames.cc, result_remarks.cc and snapshot.cc.
struct Simulation::Impl {
  std::shared_ptr<const model::FaceModel> model;
  plan::SimulationSpec spec;
  std::vector<plan::FilmLayout> films;
  FrameLayout frame_layout;
  std::vector<Eigen::Matrix3Xd> rest_film_vertices;  ///< of each film's mid-surface [m] (3, n_vertices)
  std::vector<plan::ProbePlace> probes;
  plan::InjectionSchedule schedule;
  std::unique_ptr<step::CoupledStep> stepper;
  bool settles_directly = false;        ///< the settled shape is found in place of steps
  bool is_direct = true;                ///< all steps so far were to settled shapes
  bool finishes_directly = false;       ///< it is so once all is injected in steps
  std::string hindrance;                ///< why the plan is not found directly from its beginning
  std::unique_ptr<DirectShape> direct;  ///< made when it is, for the cells that fat has entered by then
  mechanics::SimulationState state;
  Phase phase = Phase::kRunning;
  std::string reason;
  StepReport report;
  std::vector<LigamentReport> ligaments;
  double initial_volume = 0.0;
  // Buffers that every step writes again.
  step::StepOutcome attempt;              ///< what came of the last try
  std::vector<Eigen::VectorXd> injected;  ///< a film [m3] (n_cells)
  std::vector<double> delivered_before;   ///< an injection [m3]
  Eigen::Matrix3Xd moved_skin;            ///< [m] (3, nodes_per_level)

  absl::Status set_up();
  void advance();
  void decide_way();
  bool settle();
  bool is_just_injected() const;
  bool is_time_to_finish() const;
  bool finish();
  std::string find_why_not_finished(const equilibrium::Settled& settled, mechanics::SimulationState next) const;
  absl::Status make_direct();
  void become(const equilibrium::Settled& settled, mechanics::SimulationState next, double time);
  void end_path(const equilibrium::Settled& settled);
  void try_with_smaller_steps();
  double first_step_to_try(double smallest) const;
  double next_mark() const;
  void accept(double dt);
  double estimate_error(const mechanics::SimulationState& next, double dt) const;
  double allowed_step(double dt, double error) const;
  double estimate_settling_error(double last_speed, double dt) const;
  void choose_next_step(const step::StepOutcome& outcome, double dt);
  void fail(std::string why);
  void decide_phase();

  void fill_report(const step::StepOutcome& outcome, double dt);
  void report_ligaments(const step::StepOutcome& outcome);
  std::vector<LayerReport> report_layers() const;
  void remark_on_result(std::vector<std::string>& remarks) const;
  Eigen::Matrix3Xd skin_positions() const;
  Eigen::Matrix3Xd skin_displacement() const;

  struct FilmsNow;
  FilmsNow measure_films() const;
  void add_skin_fields(const FrameLayout& layout, const Eigen::Matrix3Xd& skin, const FilmsNow& now,
                       std::vector<FrameField>& fields) const;
  void add_scan_fields(const FrameLayout& layout, int n, const Eigen::Matrix3Xd& skin, const FilmsNow& now,
                       std::vector<FrameField>& fields) const;
  void add_film_fields(size_t f, const FilmsNow& now, std::vector<FrameField>& fields) const;
};

}  // namespace lipofill::simulation
