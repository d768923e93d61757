#include "core/coupling/pressure_system.h"

#include <algorithm>
#include <utility>

namespace lipofill::coupling {

PressureSystem::PressureSystem(std::vector<film::FilmProjection*> films)
    : films_(std::move(films)), matrices_(films_.size()) {
  for (const film::FilmProjection* film : films_) n_ += film->grid().n_cells();
}

/// First cell of every connected component without any compliance. Leaky walls connect.
void PressureSystem::set_compliance(const Eigen::VectorXd& compliance) {
  gauge_cells_.clear();
  int offset = 0;
  for (const film::FilmProjection* film : films_) {
    const film::FilmGrid& grid = film->grid();
    std::vector<std::vector<int>> neighbours(grid.n_cells());
    const auto connect = [&](int a, int b) {
      neighbours[a].push_back(b);
      neighbours[b].push_back(a);
    };
    for (const film::Edge& edge : grid.edges) connect(edge.left, edge.right);
    for (const film::LeakyWall& wall : grid.leaky_walls) connect(wall.left, wall.right);
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
        for (const int next : neighbours[cell]) {
          if (seen[next]) continue;
          seen[next] = true;
          stack.push_back(next);
        }
      }
      if (rigid) gauge_cells_.push_back(offset + first);
    }
    offset += grid.n_cells();
  }
}

void PressureSystem::linearise(const Eigen::VectorXd& p, const std::vector<char>& held) {
  int offset = 0;
  for (size_t f = 0; f < films_.size(); ++f) {
    const int n = films_[f]->grid().n_cells();
    matrices_[f] = &films_[f]->linearise(p.segment(offset, n));
    offset += n;
  }
  held_ = &held;
  holds_any_ = std::any_of(held.begin(), held.end(), [](char is_held) { return is_held != 0; });
}

void PressureSystem::add_mobility(const Eigen::VectorXd& p, Eigen::VectorXd& product) const {
  int offset = 0;
  for (const Eigen::SparseMatrix<double>* j : matrices_) {
    product.segment(offset, j->cols()).noalias() += *j * p.segment(offset, j->cols());
    offset += static_cast<int>(j->cols());
  }
}

void PressureSystem::hold(Eigen::VectorXd& values) const {
  for (int i = 0; i < n_; ++i) {
    if (is_held(i)) values[i] = 0.0;
  }
}

}  // namespace lipofill::coupling
