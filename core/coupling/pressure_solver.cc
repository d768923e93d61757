#include "core/coupling/pressure_solver.h"

#include <utility>

#include "core/coupling/dense_pressure_route.h"
#include "core/coupling/diagonal_pressure_route.h"
#include "core/coupling/implicit_pressure_route.h"

namespace lipofill::coupling {
namespace {

std::unique_ptr<PressureRoute> make_route(const WallCompliance& walls, int n_cells) {
  if (walls.tissue != nullptr) return std::make_unique<ImplicitPressureRoute>();
  if (walls.dense == nullptr) return std::make_unique<DiagonalPressureRoute>();
  if (n_cells > PressureSolver::kMaxDirectCells) return std::make_unique<LaggedPressureRoute>();
  return std::make_unique<DensePressureRoute>();
}

}  // namespace

PressureSolver::PressureSolver(std::vector<film::FilmProjection*> films) : system_(std::move(films)) {}

void PressureSolver::set_walls(const WallCompliance& walls) {
  if (route_ == nullptr) {
    route_ = make_route(walls, system_.n_cells());
    system_.set_compliance(walls.dense != nullptr ? Eigen::VectorXd(walls.dense->diagonal()) : walls.diagonal);
  }
  route_->set_walls(walls);
}

bool PressureSolver::solve(const Eigen::VectorXd& p, const std::vector<char>& held, const Eigen::VectorXd& r,
                           double tolerance, Eigen::VectorXd& dp, Eigen::VectorXd& moved) {
  system_.linearise(p, held);
  right_ = r;
  system_.hold(right_);
  return route_->solve(system_, right_, tolerance, dp, moved);
}

}  // namespace lipofill::coupling
