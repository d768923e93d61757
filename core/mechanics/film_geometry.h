#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/film/film_metric.h"
#include "core/mechanics/tissue_system.h"

namespace lipofill::mechanics {

/// The mid-surfaces of the films: at rest, and where the tissue's walls are. Films with walls of
/// their own lie on the undeformed skin and stay there.
class FilmGeometry {
 public:
  /// @param system  null without tissue; what is passed here outlives the geometry
  FilmGeometry(const geometry::LayeredGrid& grid, const std::vector<plan::FilmLayout>& films, const FilmCells& cells,
               const TissueSystem* system);

  /// Brings the metric of a film to positions of the tissue [m] (3, n_nodes).
  const film::FilmMetric& update(size_t film, const Eigen::Matrix3Xd& positions);
  /// Metric of a film where it was last brought.
  const film::FilmMetric& metric(size_t film) const { return metric_[film]; }
  /// Metric at other positions, made anew.
  film::FilmMetric metric_at(size_t film, const Eigen::Matrix3Xd& positions) const;
  /// Cell areas at rest [m2] (n_cells).
  const Eigen::VectorXd& rest_area(size_t film) const { return rest_metric_[film].area; }
  /// Volume of the cells of all films at their rest thickness [m3] (n cells).
  Eigen::VectorXd rest_volume() const;

 private:
  const coupling::GapVolume& gap_of(size_t film) const { return system_->gaps().film(cells_.gap_of_film[film]); }

  const std::vector<plan::FilmLayout>& films_;
  const FilmCells& cells_;
  const TissueSystem* system_;
  std::vector<film::FilmMetric> rest_metric_;
  std::vector<film::FilmMetric> metric_;  ///< of the step under way
};

}  // namespace lipofill::mechanics
