#include "core/simulation/plan_ensemble.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/coupling/algebra_threads.h"
#include "core/coupling/gap_volume.h"
#include "core/simulation/ensemble_ground.h"

namespace lipofill::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Members that a worker takes at once: as many as share the reading of a factor.
constexpr size_t kBatch = 16;
/// Memory that the workers' equations may take together [B].
constexpr uint64_t kMemoryBound = uint64_t{3} << 29;
}  // namespace

/// One thread's share of the ensemble.
class PlanEnsemble::Worker {
 public:
  absl::Status set_up(const std::shared_ptr<const model::FaceModel>& model, const plan::SimulationSpec& spec,
                      const VectorXd& kept);
  /// Finds members and writes what came of them to `results`.
  void find(const PlanChange* changes, size_t n, MemberResult* results);
  MemberShape nominal(size_t time) { return describe(times_[time]->ensemble->nominal()); }
  std::vector<std::string> zones() const;
  uint64_t memory_bytes() const { return times_.size() * times_.front()->stepper->memory_bytes(); }

 private:
  const Ground& ground() const { return *times_.front(); }
  VectorXd pool_volumes(const VectorXd& of_injections, double kept) const;
  MemberShape describe(const equilibrium::Settled& settled) const;
  std::vector<std::unique_ptr<OtherTissue>> make_tissues(const PlanChange* changes, size_t n, MemberResult* results);

  std::shared_ptr<const model::FaceModel> model_;
  plan::SimulationSpec spec_;
  std::vector<std::unique_ptr<Ground>> times_;
  VectorXd rest_;                     ///< of the pools [m3]
  std::vector<VectorXd> into_pools_;  ///< of each injection's volume [m3] (n_pools)
};

absl::Status PlanEnsemble::Worker::set_up(const std::shared_ptr<const model::FaceModel>& model,
                                          const plan::SimulationSpec& spec, const VectorXd& kept) {
  model_ = model;
  spec_ = spec;
  spec_.goal = plan::TimeGoal::kSettledShape;
  for (Index time = 0; time < kept.size(); ++time) {
    plan::InjectionSchedule schedule;
    Ground& made = *times_.emplace_back(std::make_unique<Ground>());
    if (const absl::Status status = make_ground(*model_, spec_, made, schedule); !status.ok()) return status;
    if (time == 0) {
      rest_ = made.direct->pool_volumes(made.rest);
      into_pools_ = find_injected(made, *model_, spec_, schedule);
    }
    const VectorXd all = VectorXd::Ones(static_cast<Index>(into_pools_.size()));
    made.ensemble =
        std::make_unique<equilibrium::Ensemble>(made.direct->begin_ensemble(made.rest, pool_volumes(all, kept[time])));
    const equilibrium::Settled& nominal = made.ensemble->nominal();
    if (nominal.is_whole()) continue;
    return absl::FailedPreconditionError(absl::StrCat("the plan itself has no settled shape: ", 100.0 * nominal.share,
                                                      " % of its fat goes in, then ", nominal.reason));
  }
  return absl::OkStatus();
}

/// Fat that is taken out stays out.
VectorXd PlanEnsemble::Worker::pool_volumes(const VectorXd& of_injections, double kept) const {
  VectorXd volumes = rest_;
  for (size_t k = 0; k < into_pools_.size(); ++k) {
    const double part = into_pools_[k].sum() > 0.0 ? kept : 1.0;
    volumes += part * of_injections[static_cast<Index>(k)] * into_pools_[k];
  }
  return volumes;
}

std::vector<std::unique_ptr<OtherTissue>> PlanEnsemble::Worker::make_tissues(const PlanChange* changes, size_t n,
                                                                             MemberResult* results) {
  std::vector<std::unique_ptr<OtherTissue>> tissues(n);
  for (size_t k = 0; k < n; ++k) {
    if ((changes[k].thickness.array() == 1.0).all()) continue;
    auto made = make_tissue(ground(), *model_, spec_, changes[k].thickness);
    if (made.ok()) {
      tissues[k] = *std::move(made);
    } else {
      results[k].failure = std::string(made.status().message());
    }
  }
  return tissues;
}

void PlanEnsemble::Worker::find(const PlanChange* changes, size_t n, MemberResult* results) {
  const auto tissues = make_tissues(changes, n, results);
  for (size_t time = 0; time < times_.size(); ++time) {
    std::vector<equilibrium::MemberChange> asked;
    std::vector<size_t> who;
    for (size_t k = 0; k < n; ++k) {
      if (!results[k].failure.empty()) continue;
      asked.push_back({changes[k].moduli, pool_volumes(changes[k].volumes, changes[k].kept[static_cast<Index>(time)]),
                       tissues[k] ? tissues[k]->equilibrium.get() : nullptr});
      who.push_back(k);
    }
    const auto found = times_[time]->ensemble->find(asked);
    for (size_t k = 0; k < who.size(); ++k) {
      MemberResult& result = results[who[k]];
      if (!found[k].ok()) {
        result.failure = std::string(found[k].status().message());
      } else if (!found[k]->is_whole()) {
        result.failure = found[k]->reason.empty() ? "not all of its fat goes in" : found[k]->reason;
      } else {
        result.shapes.push_back(describe(*found[k]));
      }
    }
  }
  for (size_t k = 0; k < n; ++k) {
    if (!results[k].failure.empty()) results[k].shapes.clear();
  }
}

MemberShape PlanEnsemble::Worker::describe(const equilibrium::Settled& settled) const {
  const Ground& at = ground();
  const geometry::LayeredGrid& grid = model_->geometry.grid;
  const std::vector<int>& skin_nodes = at.stepper->tissue()->skin_nodes;
  Eigen::Matrix3Xd skin(3, grid.nodes_per_level());
  for (Index s = 0; s < skin.cols(); ++s) skin.col(s) = settled.positions.col(skin_nodes[static_cast<size_t>(s)]);
  const Eigen::Matrix3Xd displacement = skin - grid.nodes.leftCols(skin.cols());
  MemberShape shape;
  shape.skin = displacement.cast<float>();
  shape.max_lift = displacement.colwise().norm().maxCoeff();
  shape.skin_volume = coupling::compute_swept_volume(grid, grid.nodes, skin);
  std::vector<double> pressure, volume;
  Index row = 0;
  for (size_t f = 0; f < at.films.size(); ++f) {
    const plan::FilmLayout& film = at.films[f];
    if (!at.stepper->cells().is_on_tissue(f)) continue;
    const VectorXd area = at.stepper->geometry().metric_at(f, settled.positions).area;
    const auto n_zones = static_cast<Index>(film.zone_names.size());
    VectorXd of_zone = VectorXd::Zero(n_zones), area_of_zone = of_zone, in_zone = of_zone;
    for (int cell = 0; cell < film.grid.n_cells(); ++cell, ++row) {
      const int zone = film.grid.zone_of_cell[static_cast<size_t>(cell)];
      of_zone[zone] += area[cell] * settled.cell_pressure[row];
      area_of_zone[zone] += area[cell];
      in_zone[zone] += settled.cell_volume[row];
    }
    for (Index zone = 0; zone < n_zones; ++zone) {
      pressure.push_back(of_zone[zone] / area_of_zone[zone]);
      volume.push_back(in_zone[zone]);
    }
  }
  shape.pressure = VectorXd::Map(pressure.data(), static_cast<Index>(pressure.size()));
  shape.volume = VectorXd::Map(volume.data(), static_cast<Index>(volume.size()));
  return shape;
}

std::vector<std::string> PlanEnsemble::Worker::zones() const {
  std::vector<std::string> names;
  const Ground& at = ground();
  for (size_t f = 0; f < at.films.size(); ++f) {
    if (!at.stepper->cells().is_on_tissue(f)) continue;
    names.insert(names.end(), at.films[f].zone_names.begin(), at.films[f].zone_names.end());
  }
  return names;
}

PlanEnsemble::PlanEnsemble() = default;
PlanEnsemble::~PlanEnsemble() = default;

absl::StatusOr<std::unique_ptr<PlanEnsemble>> PlanEnsemble::create(std::shared_ptr<const model::FaceModel> model,
                                                                   const plan::SimulationSpec& spec,
                                                                   const VectorXd& kept, int workers) {
  std::unique_ptr<PlanEnsemble> ensemble(new PlanEnsemble);
  uint64_t memory = 0;
  for (int k = 0; k < workers; ++k) {
    auto worker = std::make_unique<Worker>();
    if (const absl::Status made = worker->set_up(model, spec, kept); !made.ok()) return made;
    memory += worker->memory_bytes();
    ensemble->workers_.push_back(std::move(worker));
    if (memory + memory / (k + 1) > kMemoryBound) break;
  }
  Worker& first = *ensemble->workers_.front();
  ensemble->zones_ = first.zones();
  for (Index time = 0; time < kept.size(); ++time) {
    ensemble->nominal_.push_back(first.nominal(static_cast<size_t>(time)));
  }
  return ensemble;
}

absl::StatusOr<std::vector<MemberResult>> PlanEnsemble::find(const std::vector<PlanChange>& changes, const Done& done) {
  std::vector<MemberResult> results(changes.size());
  std::atomic<size_t> next = 0;
  std::atomic<bool> is_stopped = false;
  std::mutex mutex;
  size_t n_done = 0;
  std::exception_ptr failure;
  const auto work = [&](Worker& worker) {
    try {
      coupling::pin_algebra_to_this_thread();
      for (size_t first = next.fetch_add(kBatch); first < changes.size() && !is_stopped;
           first = next.fetch_add(kBatch)) {
        const size_t n = std::min(kBatch, changes.size() - first);
        worker.find(&changes[first], n, &results[first]);
        const std::lock_guard lock(mutex);
        n_done += n;
        if (done && !done(static_cast<int>(n_done))) is_stopped = true;
      }
    } catch (...) {  // an allocation that failed: thrown again where somebody catches it
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
      is_stopped = true;
    }
  };
  std::vector<std::thread> threads;
  for (size_t k = 1; k < workers_.size(); ++k) threads.emplace_back(work, std::ref(*workers_[k]));
  work(*workers_.front());
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
  if (is_stopped) return absl::CancelledError("the ensemble was stopped");
  return results;
}

}  // namespace lipofill::simulation
