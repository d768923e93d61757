#include "core/step/wall_response.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lipofill::step {
namespace {

/// C has negative entries on curved layers; a lumped cell keeps at least this share of its own
/// compliance, so that J + R stays definite.
constexpr double kLeastOwnShare = 1e-3;

}  // namespace

WallResponse::WallResponse(const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
                           const mechanics::FilmGeometry& geometry, plan::CouplingMode coupling,
                           coupling::CoupledFactor* factor)
    : films_(films),
      cells_(cells),
      geometry_(geometry),
      coupling_(coupling),
      factor_(factor),
      rest_volume_(geometry.rest_volume()) {}

void WallResponse::update() {
  walls_.diagonal.setZero(cells_.n());
  for (size_t f = 0; f < films_.size(); ++f) {
    if (films_[f].wall != plan::FilmWallKind::kWinkler) continue;
    walls_.diagonal.segment(cells_.offset[f], cells_.n_of(f)) = geometry_.rest_area(f) / films_[f].wall_stiffness;
  }
  if (cells_.on_tissue.empty()) return;
  const Eigen::VectorXd& lumped = factor_->lumped_compliance();
  const double mean = lumped.mean();
  for (size_t k = 0; k < cells_.on_tissue.size(); ++k) {
    const double own = is_implicit() ? mean : factor_->compliance()(k, k);
    walls_.diagonal[cells_.on_tissue[k]] = std::max(lumped[k], kLeastOwnShare * own);
  }
  if (coupling_ == plan::CouplingMode::kLumped) return;
  if (is_implicit()) {
    walls_.tissue = factor_;
    walls_.tissue_cells = &cells_.on_tissue;
    return;
  }
  const bool is_all_on_tissue = static_cast<int>(cells_.on_tissue.size()) == cells_.n();
  if (!is_all_on_tissue) set_full_compliance(factor_->compliance());
  walls_.dense = is_all_on_tissue ? &factor_->compliance() : &full_compliance_;
}

void WallResponse::set_full_compliance(const Eigen::MatrixXd& of_tissue) {
  full_compliance_ = walls_.diagonal.asDiagonal();
  const std::vector<int>& cells = cells_.on_tissue;
  for (size_t b = 0; b < cells.size(); ++b) {
    for (size_t a = 0; a < cells.size(); ++a) full_compliance_(cells[a], cells[b]) = of_tissue(a, b);
  }
}

void WallResponse::compute_gap_of_own_walls(const Eigen::VectorXd& pressure, Eigen::VectorXd& gap) const {
  gap = rest_volume_;
  for (size_t f = 0; f < films_.size(); ++f) {
    if (films_[f].wall != plan::FilmWallKind::kWinkler) continue;
    gap.segment(cells_.offset[f], cells_.n_of(f)) +=
        pressure.segment(cells_.offset[f], cells_.n_of(f)).cwiseProduct(geometry_.rest_area(f)) /
        films_[f].wall_stiffness;
  }
}

double WallResponse::relative_gap_error(const Eigen::VectorXd& gap, const coupling::FilmSolution& solution) const {
  const auto held = solution.volume + solution.void_volume;
  const double total = std::max(held.sum(), std::numeric_limits<double>::min());
  if (coupling_ == plan::CouplingMode::kLumped) return std::abs((gap - held).sum()) / total;
  return (gap - held).cwiseAbs().sum() / total;
}

}  // namespace lipofill::step
