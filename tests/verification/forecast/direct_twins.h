#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/forecast/uncertain_input.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::verification {

/// Patients that an ensemble is held against: plans of their own on models of their own, solved
/// from rest, one after the other. They share no code with ensembles but the model itself.

/// The result of one: its largest lift [m], the volume that its skin gains [m3], the pressure of
/// its zone [Pa], and the lift of each node [m].
struct Twin {
  double lift = 0.0;
  double volume = 0.0;
  double pressure = 0.0;
  Eigen::VectorXd lift_of_node;

  static constexpr int kFigures = 3;
  double figure(int k) const { return k == 0 ? lift : k == 1 ? volume : pressure; }
};

/// A plate of two layers with one zone between them, whose stiffness and thickness and delivered
/// volume are not known.
struct TwinCase {
  model::FaceModelSpec model;
  plan::SimulationSpec plan;
  std::vector<forecast::UncertainInput> inputs;
};
TwinCase make_twin_case();

/// Solves the patients whose inputs have these values (n, inputs), on some threads. Neither their
/// number nor the order changes a byte. A patient without a settled shape fails the test.
std::vector<Twin> solve_twins(const TwinCase& twin_case, const Eigen::MatrixXd& values, int threads);

/// Values that are drawn at random, each input of all patients evenly over its distribution (a
/// Latin hypercube): fresh to an ensemble, and with less chance in what share of them an interval
/// holds.
Eigen::MatrixXd draw_evenly(const std::vector<forecast::UncertainInput>& inputs, int n, unsigned seed);

/// Sobol indices of each figure by pick and freeze: with two independent samples A and B of n
/// patients, and A_i, which is A with input i of B,
///
///     S_i = 1 - sum (f(B) - f(A_i))^2 / (2 n V),   T_i = sum (f(A) - f(A_i))^2 / (2 n V)
///
/// (Jansen 1999), V: the variance over A and B. n (inputs + 2) patients are solved. Errors:
/// patients drawn again with replacement.
struct PickedIndices {
  Eigen::MatrixXd first, total;              ///< (figures, inputs)
  Eigen::MatrixXd first_error, total_error;  ///< standard errors
  std::vector<Twin> patients;                ///< those of A and B
  int runs = 0;
};
PickedIndices find_indices_by_runs(const TwinCase& twin_case, int n, int threads);

}  // namespace lipofill::verification
