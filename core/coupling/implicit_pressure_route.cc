#include "core/coupling/implicit_pressure_route.h"

namespace lipofill::coupling {
namespace {

constexpr int kMaxIterations = 200;

}  // namespace

void ImplicitPressureRoute::multiply_walls(const Eigen::VectorXd& p, Eigen::VectorXd& product) {
  const std::vector<int>& cells = *walls_.tissue_cells;
  product = walls_.diagonal.cwiseProduct(p);
  on_tissue_.resize(static_cast<Eigen::Index>(cells.size()));
  for (size_t k = 0; k < cells.size(); ++k) on_tissue_[k] = p[cells[k]];
  walls_.tissue->multiply_compliance(on_tissue_, moved_on_tissue_);
  for (size_t k = 0; k < cells.size(); ++k) product[cells[k]] = moved_on_tissue_[k];
}

bool ImplicitPressureRoute::solve(const PressureSystem& system, const Eigen::VectorXd& r, double tolerance,
                                  Eigen::VectorXd& dp, Eigen::VectorXd& moved) {
  if (!factor_.factor(system, walls_.diagonal)) return false;
  const auto precondition = [this](const Eigen::VectorXd& from, Eigen::VectorXd& to) { factor_.solve(from, to); };
  const auto move = [this](const ConjugateGradients::Iterate& at, Eigen::VectorXd& moved_direction) {
    multiply_walls(at.direction, moved_direction);
  };
  return gradients_.solve(system, r, tolerance, kMaxIterations, precondition, move, dp, moved);
}

}  // namespace lipofill::coupling
