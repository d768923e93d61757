#include "core/mechanics/film_geometry.h"

namespace lipofill::mechanics {

FilmGeometry::FilmGeometry(const geometry::LayeredGrid& grid, const std::vector<plan::FilmLayout>& films,
                           const FilmCells& cells, const TissueSystem* system)
    : films_(films), cells_(cells), system_(system) {
  for (size_t f = 0; f < films.size(); ++f) {
    rest_metric_.push_back(
        film::compute_film_metric(films[f].grid, cells.is_on_tissue(f) ? gap_of(f).mid_surface(system->rest_positions())
                                                                       : plan::vertices_on_skin(grid, films[f].grid)));
  }
  metric_ = rest_metric_;
}

const film::FilmMetric& FilmGeometry::update(size_t film, const Eigen::Matrix3Xd& positions) {
  if (cells_.is_on_tissue(film)) {
    gap_of(film).mid_surface(positions, metric_[film].vertices);
    film::update_film_metric(films_[film].grid, metric_[film]);
  }
  return metric_[film];
}

film::FilmMetric FilmGeometry::metric_at(size_t film, const Eigen::Matrix3Xd& positions) const {
  if (!cells_.is_on_tissue(film)) return rest_metric_[film];
  return film::compute_film_metric(films_[film].grid, gap_of(film).mid_surface(positions));
}

Eigen::VectorXd FilmGeometry::rest_volume() const {
  Eigen::VectorXd volume(cells_.n());
  for (size_t f = 0; f < films_.size(); ++f) {
    for (int cell = 0; cell < cells_.n_of(f); ++cell) {
      const geometry::ChartPoint centre = films_[f].cell_centre(cell);
      volume[cells_.offset[f] + cell] = rest_area(f)[cell] * films_[f].rest_thickness.at(centre.xi, centre.eta);
    }
  }
  return volume;
}

}  // namespace lipofill::mechanics
