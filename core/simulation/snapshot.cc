#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

#include "core/base/hash.h"
#include "core/simulation/simulation_impl.h"

namespace lipofill::simulation {
namespace {

constexpr char kMagic[] = "lipofill-state-7";

/// Visits every number of the mutable state in a fixed order, so that writing, reading and hashing
/// cannot disagree.
template <typename Visitor>
void visit_state(mechanics::SimulationState& state, Visitor& visit) {
  visit.number(state.step);
  visit.number(state.time);
  visit.number(state.last_step);
  visit.number(state.next_step);
  visit.number(state.rejected_steps);
  visit.number(state.slow_steps);
  visit.number(state.skin_speed);
  visit.number(state.injection_work);
  visit.number(state.film_dissipation);
  visit.array(state.positions.data(), state.positions.size());
  visit.array(state.velocities.data(), state.velocities.size());
  visit.number(state.equal_steps);
  for (Eigen::Matrix3Xd& velocities : state.earlier_velocities) visit.array(velocities.data(), velocities.size());
  visit.array(state.spring_is_intact.data(), state.spring_is_intact.size());
  visit.number(state.factored_dt);
  visit.number(state.factored_in_double);
  visit.number(state.late_iterations);
  visit.number(state.late_pressure_iterations);
  visit.array(state.factored_positions.data(), state.factored_positions.size());
  visit.array(state.factored_springs.data(), state.factored_springs.size());
  for (mechanics::FilmState& film : state.films) {
    for (Eigen::VectorXd* values : {&film.volume, &film.pressure, &film.velocity, &film.volume_rate,
                                    &film.pressure_rate, &film.earlier_volume_rate, &film.earlier_pressure_rate,
                                    &film.wall_stress, &film.factored_mobility, &film.is_entered}) {
      visit.array(values->data(), values->size());
    }
  }
}

struct Writer {
  std::string bytes;
  template <typename T>
  void number(T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void array(double* values, Eigen::Index count) {
    number(count);
    bytes.append(reinterpret_cast<const char*>(values), static_cast<size_t>(count) * sizeof(double));
  }
};

struct Reader {
  std::string_view bytes;
  bool ok = true;
  void raw(void* out, size_t size) {
    ok = ok && bytes.size() >= size;
    if (!ok || size == 0) return;  // memcpy must not be given what an empty array begins with
    std::memcpy(out, bytes.data(), size);
    bytes.remove_prefix(size);
  }
  template <typename T>
  void number(T& value) {
    raw(&value, sizeof value);
    if constexpr (std::is_floating_point_v<T>) ok = ok && std::isfinite(value);
  }
  void array(double* values, Eigen::Index count) {
    Eigen::Index stored = -1;
    number(stored);
    ok = ok && stored == count;
    if (ok) raw(values, static_cast<size_t>(count) * sizeof(double));
    ok = ok && Eigen::Map<const Eigen::ArrayXd>(values, count).isFinite().all();
  }
};

/// False for a state that no simulation can reach, whatever its numbers.
bool is_possible(const mechanics::SimulationState& state, int phase) {
  const bool is_phase = phase >= static_cast<int>(Phase::kRunning) && phase <= static_cast<int>(Phase::kFailed);
  const bool is_counted = state.slow_steps >= 0 && state.equal_steps >= 0 && state.late_iterations >= 0 &&
                          state.late_pressure_iterations >= 0 &&
                          (state.factored_in_double == 0 || state.factored_in_double == 1);
  const bool is_timed =
      state.time >= 0.0 && state.last_step >= 0.0 && state.next_step > 0.0 && state.factored_dt >= 0.0;
  return is_phase && is_counted && is_timed;
}

struct HashVisitor {
  Hasher hasher;
  template <typename T>
  void number(T& value) {
    hasher.add(value);
  }
  void array(double* values, Eigen::Index count) {
    hasher.add_bytes(values, static_cast<size_t>(count) * sizeof(double));
  }
};

}  // namespace

std::string Simulation::state_hash() const {
  HashVisitor visitor;
  mechanics::SimulationState state = impl_->state;
  visit_state(state, visitor);
  return visitor.hasher.hex_digest();
}

std::string Simulation::snapshot() const {
  Writer writer;
  writer.bytes = kMagic;
  mechanics::SimulationState state = impl_->state;
  visit_state(state, writer);
  int phase = static_cast<int>(impl_->phase);
  writer.number(phase);
  int is_direct = impl_->is_direct;
  writer.number(is_direct);
  std::vector<double> delivered = impl_->schedule.delivered_each();
  writer.array(delivered.data(), static_cast<Eigen::Index>(delivered.size()));
  double total = impl_->schedule.delivered();
  writer.number(total);
  double initial = impl_->initial_volume;
  writer.number(initial);
  return writer.bytes;
}

absl::Status Simulation::restore(std::string_view snapshot) {
  Impl& impl = *impl_;
  const size_t magic_size = sizeof kMagic - 1;
  Reader reader{snapshot.substr(std::min(magic_size, snapshot.size()))};
  mechanics::SimulationState state = impl.state;
  double total = 0.0, initial = 0.0;
  int phase = 0;
  int is_direct = 0;
  std::vector<double> delivered = impl.schedule.delivered_each();
  visit_state(state, reader);
  reader.number(phase);
  reader.number(is_direct);
  reader.array(delivered.data(), static_cast<Eigen::Index>(delivered.size()));
  reader.number(total);
  reader.number(initial);
  if (!snapshot.starts_with(kMagic) || !reader.ok || !reader.bytes.empty()) {
    return absl::DataLossError(
        "not a state of this simulation: its size or mark is another, or a number is not finite");
  }
  if (!is_possible(state, phase) || (is_direct != 0 && is_direct != 1))
    return absl::DataLossError("a state that no simulation comes to");
  impl.state = std::move(state);
  impl.phase = static_cast<Phase>(phase);
  impl.schedule.restore_delivered(delivered, total);
  impl.initial_volume = initial;
  impl.is_direct = is_direct == 1;
  if (!impl.is_direct && impl.settles_directly) impl.report.way = "in steps: it was begun in them";
  impl.fill_report(impl.stepper->describe(impl.state), impl.state.last_step);
  return absl::OkStatus();
}

}  // namespace lipofill::simulation
