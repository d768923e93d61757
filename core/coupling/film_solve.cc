#include "core/coupling/film_solve.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <limits>
#include <utility>

namespace lipofill::coupling {
namespace {

constexpr int kMaxIterations = 60;
/// An edge of hardly any flow between thick and thin cells may turn round in every iteration; from here on each keeps
/// its direction. Its flow is then too small to matter, or the volume of a cell turns negative and the step is refused.
constexpr int kFreeDirectionIterations = 12;
constexpr int kUndampedIterations = 20;
constexpr double kTolerance = 1e-10;

/// One linear solve (dt J + C) p = d.
class PressureSolver {
 public:
  PressureSolver(const std::vector<film::FilmProjection*>& films, const WallCompliance& walls, int n)
      : films_(films), walls_(walls), n_(n) {
    find_rigid_components(walls.full != nullptr ? Eigen::VectorXd(walls.full->diagonal()) : walls.diagonal);
  }

  bool solve(const Eigen::VectorXd& d, Eigen::VectorXd& p) {
    return walls_.full != nullptr ? solve_full(d, p) : solve_sparse(d, p);
  }

 private:
  bool solve_full(const Eigen::VectorXd& d, Eigen::VectorXd& p) {
    system_ = *walls_.full;
    for_each_entry([&](int row, int column, double value) { system_(row, column) += value; });
    for (const int i : gauge_cells_) system_(i, i) *= 2.0;
    dense_.compute(system_);
    if (dense_.info() != Eigen::Success) return false;
    p = dense_.solve(d);
    return p.allFinite();
  }

  bool solve_sparse(const Eigen::VectorXd& d, Eigen::VectorXd& p) {
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(10 * static_cast<size_t>(n_));
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(n_);
    for_each_entry([&](int row, int column, double value) {
      triplets.emplace_back(row, column, value);
      if (row == column) diagonal[row] = value;
    });
    for (int i = 0; i < n_; ++i) triplets.emplace_back(i, i, walls_.diagonal[i]);
    for (const int i : gauge_cells_) triplets.emplace_back(i, i, diagonal[i]);
    Eigen::SparseMatrix<double> system(n_, n_);
    system.setFromTriplets(triplets.begin(), triplets.end());
    if (!analysed_) sparse_.analyzePattern(system);
    analysed_ = true;
    sparse_.factorize(system);
    if (sparse_.info() != Eigen::Success) return false;
    p = sparse_.solve(d);
    return p.allFinite();
  }

  template <typename Visit>
  void for_each_entry(Visit visit) {
    int offset = 0;
    for (const film::FilmProjection* film : films_) {
      const auto& j = film->pressure_matrix();
      for (int column = 0; column < j.outerSize(); ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(j, column); it; ++it) {
          visit(offset + static_cast<int>(it.row()), offset + column, it.value());
        }
      }
      offset += film->grid().n_cells();
    }
  }

  /// First cell of every connected component without any compliance.
  void find_rigid_components(const Eigen::VectorXd& compliance) {
    int offset = 0;
    for (const film::FilmProjection* film : films_) {
      const film::FilmGrid& grid = film->grid();
      std::vector<bool> seen(grid.n_cells(), false);
      for (int first = 0; first < grid.n_cells(); ++first) {
        if (seen[first]) continue;
        bool rigid = true;
        std::vector<int> stack = {first};
        seen[first] = true;
        while (!stack.empty()) {
          const int cell = stack.back();
          stack.pop_back();
          rigid = rigid && compliance[offset + cell] == 0.0;
          for (const film::Side side : {film::kLowXi, film::kHighXi, film::kLowEta, film::kHighEta}) {
            const int next = grid.neighbour(cell, side);
            if (next < 0 || seen[next]) continue;
            seen[next] = true;
            stack.push_back(next);
          }
        }
        if (rigid) gauge_cells_.push_back(offset + first);
      }
      offset += grid.n_cells();
    }
  }

  const std::vector<film::FilmProjection*>& films_;
  const WallCompliance& walls_;
  int n_;
  std::vector<int> gauge_cells_;
  Eigen::MatrixXd system_;
  Eigen::LLT<Eigen::MatrixXd> dense_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> sparse_;
  bool analysed_ = false;
};

void linearise_all(const std::vector<film::FilmProjection*>& films, const Eigen::VectorXd& volume,
                   const std::vector<Eigen::VectorXd>& flux) {
  int offset = 0;
  for (size_t f = 0; f < films.size(); ++f) {
    films[f]->linearise(volume.segment(offset, films[f]->grid().n_cells()), flux[f]);
    offset += films[f]->grid().n_cells();
  }
}

Eigen::VectorXd gather_explicit_volume(const std::vector<film::FilmProjection*>& films, int n) {
  Eigen::VectorXd volume(n);
  int offset = 0;
  for (const film::FilmProjection* film : films) {
    volume.segment(offset, film->grid().n_cells()) = film->explicit_volume();
    offset += film->grid().n_cells();
  }
  return volume;
}

void apply_pressure(const std::vector<film::FilmProjection*>& films, FilmSolveResult& result) {
  int offset = 0;
  for (size_t f = 0; f < films.size(); ++f) {
    const int n = films[f]->grid().n_cells();
    result.flux[f] = films[f]->compute_flux(result.pressure.segment(offset, n));
    result.volume.segment(offset, n) = films[f]->compute_volume(result.flux[f]);
    offset += n;
  }
}

}  // namespace

FilmSolveResult solve_films(std::vector<film::FilmProjection*> films, const WallCompliance& walls,
                            const Eigen::VectorXd& gap_without_pressure, const FilmSolveResult& start) {
  const int n = static_cast<int>(gap_without_pressure.size());
  PressureSolver solver(films, walls, n);
  FilmSolveResult result = start;
  Eigen::VectorXd guess = start.volume;
  std::vector<Eigen::VectorXd> direction = start.flux;
  for (result.iterations = 1; result.iterations <= kMaxIterations; ++result.iterations) {
    if (result.iterations <= kFreeDirectionIterations) direction = result.flux;
    linearise_all(films, guess, direction);
    if (!solver.solve(gather_explicit_volume(films, n) - gap_without_pressure, result.pressure)) break;
    apply_pressure(films, result);
    const double fullest = std::max(result.volume.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
    result.change = (result.volume - guess).cwiseAbs().maxCoeff() / fullest;
    if (result.change <= kTolerance) {
      result.converged = result.volume.minCoeff() >= -kTolerance * fullest;
      break;
    }
    const double blend = result.iterations < kUndampedIterations ? 1.0 : 0.5;
    guess += blend * (result.volume - guess);
  }
  return result;
}

}  // namespace lipofill::coupling
