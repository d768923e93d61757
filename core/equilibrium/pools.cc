#include "core/equilibrium/pools.h"

#include <numeric>
#include <set>
#include <utility>

#include "absl/strings/str_join.h"

namespace lipofill::equilibrium {
namespace {

/// Disjoint sets of cells; the first cell of a set stands for it.
class CellSets {
 public:
  explicit CellSets(int n) : above_(n) { std::iota(above_.begin(), above_.end(), 0); }
  int first_of(int cell) {
    while (above_[cell] != cell) cell = above_[cell] = above_[above_[cell]];
    return cell;
  }
  void join(int a, int b) {
    const int first = first_of(a);
    const int second = first_of(b);
    above_[std::max(first, second)] = std::min(first, second);
  }

 private:
  std::vector<int> above_;
};

std::string join_names(const plan::FilmLayout& film, const std::set<int>& zones) {
  return absl::StrJoin(zones, " + ", [&](std::string* out, int zone) { out->append(film.zone_names[zone]); });
}

void add_pools_of(const plan::FilmLayout& film, const Eigen::VectorXd& entered, Pools& pools) {
  const film::FilmGrid& grid = film.grid;
  const auto is_open = [&](int cell) { return entered.size() == 0 || entered[cell] > 0.0; };
  CellSets sets(grid.n_cells());
  const auto join = [&](int left, int right) {
    if (is_open(left) && is_open(right)) sets.join(left, right);
  };
  for (const film::Edge& edge : grid.edges) join(edge.left, edge.right);
  for (const film::LeakyWall& wall : grid.leaky_walls) join(wall.left, wall.right);
  std::vector<int> pool_of_first(grid.n_cells(), -1);
  std::vector<std::set<int>> zones;
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    int& pool = pool_of_first[sets.first_of(cell)];
    if (pool < 0) {
      pool = static_cast<int>(zones.size());
      zones.emplace_back();
    }
    zones[pool].insert(grid.zone_of_cell[cell]);
    pools.of_cell.push_back(pools.n() + pool);
  }
  for (const std::set<int>& of_pool : zones) pools.names.push_back(join_names(film, of_pool));
}

}  // namespace

Eigen::VectorXd Pools::sum(const Eigen::VectorXd& of_cells) const {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(n());
  for (int cell = 0; cell < n_cells(); ++cell) sums[of_cell[cell]] += of_cells[cell];
  return sums;
}

Pools find_pools(const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
                 const std::vector<Eigen::VectorXd>& entered) {
  Pools pools;
  for (size_t f = 0; f < films.size(); ++f) {
    if (cells.is_on_tissue(f)) add_pools_of(films[f], entered.empty() ? Eigen::VectorXd() : entered[f], pools);
  }
  return pools;
}

}  // namespace lipofill::equilibrium
