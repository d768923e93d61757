#include "core/coupling/gap_system.h"

#include <algorithm>
#include <utility>

namespace lipofill::coupling {

GapSystem::GapSystem(std::vector<GapVolume> films, int n_dofs) : films_(std::move(films)) {
  std::vector<Eigen::Triplet<double>> pattern;
  int offset = 0;
  for (const GapVolume& film : films_) {
    for (int column = 0; column < n_dofs; ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(film.derivative(), column); it; ++it) {
        pattern.emplace_back(offset + static_cast<int>(it.row()), column, 0.0);
      }
    }
    offset += static_cast<int>(film.volume().size());
  }
  volume_.setZero(offset);
  derivative_.resize(offset, n_dofs);
  derivative_.setFromTriplets(pattern.begin(), pattern.end());
  derivative_.makeCompressed();
}

void GapSystem::collect_volume() {
  Eigen::Index offset = 0;
  for (const GapVolume& film : films_) {
    volume_.segment(offset, film.volume().size()) = film.volume();
    offset += film.volume().size();
  }
}

void GapSystem::evaluate_volume(const Eigen::Matrix3Xd& x) {
  for (GapVolume& film : films_) film.evaluate_volume(x);
  collect_volume();
}

void GapSystem::evaluate(const Eigen::Matrix3Xd& x) {
  for (GapVolume& film : films_) film.evaluate(x);
  collect_volume();
  // Rows of a column come film by film, so that each film's column is one run of it.
  double* next = derivative_.valuePtr();
  for (int column = 0; column < derivative_.cols(); ++column) {
    for (const GapVolume& film : films_) {
      const auto& b = film.derivative();
      const int* start = b.outerIndexPtr();
      next = std::copy(b.valuePtr() + start[column], b.valuePtr() + start[column + 1], next);
    }
  }
}

}  // namespace lipofill::coupling
