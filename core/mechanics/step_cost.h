#pragma once

#include <cstdint>
#include <ctime>

namespace lipofill::mechanics {

/// CPU time of a step by phase [s], on its thread, tries that were taken back included: what it
/// costs, however busy the machine. What is left of the total is bookkeeping.
struct StepTimes {
  double element = 0.0;   ///< forces and stiffness of the tissue
  double factor = 0.0;    ///< factorisation, compliance and preconditioner
  double solve = 0.0;     ///< gap response and displacement from the factor
  double film = 0.0;      ///< the films' motion, thickness and pressure
  double coupling = 0.0;  ///< gap volumes, balance of forces
  double total = 0.0;

  void add(const StepTimes& other) {
    element += other.element;
    factor += other.factor;
    solve += other.solve;
    film += other.film;
    coupling += other.coupling;
    total += other.total;
  }
};

/// The cost of a step: no part of the state, and nothing depends on it.
struct StepCost {
  StepTimes times;
  int factorisations = 0;
  int tissue_solves = 0;
  int film_iterations = 0;       ///< counts those on the thickness
  int newton_iterations = 0;     ///< counts those of tissue and films together
  int iterative_iterations = 0;  ///< conjugate gradients on J + C
  int fallbacks = 0;             ///< float64 in place of float32, a direct solve in place of an iterative one
};

/// The cost of many steps.
struct CostSum {
  StepTimes times;
  uint64_t factorisations = 0;
  uint64_t tissue_solves = 0;
  uint64_t film_iterations = 0;
  uint64_t newton_iterations = 0;
  uint64_t iterative_iterations = 0;
  uint64_t fallbacks = 0;

  void add(const StepCost& cost) {
    times.add(cost.times);
    factorisations += static_cast<uint64_t>(cost.factorisations);
    tissue_solves += static_cast<uint64_t>(cost.tissue_solves);
    film_iterations += static_cast<uint64_t>(cost.film_iterations);
    newton_iterations += static_cast<uint64_t>(cost.newton_iterations);
    iterative_iterations += static_cast<uint64_t>(cost.iterative_iterations);
    fallbacks += static_cast<uint64_t>(cost.fallbacks);
  }
};

/// Adds the CPU time of its own life to a phase.
class PhaseTimer {
 public:
  explicit PhaseTimer(double& seconds) : seconds_(seconds), start_(now()) {}
  ~PhaseTimer() { seconds_ += now() - start_; }
  PhaseTimer(const PhaseTimer&) = delete;
  PhaseTimer& operator=(const PhaseTimer&) = delete;

 private:
  static double now() {
    timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double& seconds_;
  double start_;
};

}  // namespace lipofill::mechanics
