#include "core/coupling/gap_volume.h"

#include <cmath>
#include <utility>

#include "core/coupling/gap_integral.h"

namespace lipofill::coupling {
namespace {

GapPiece<Lanes> gather_pieces(const GapGeometry::Batch& batch, const double* x) {
  GapPiece<Lanes> pieces;
  for (int c = 0; c < 4; ++c) {
    const Vector3<Lanes> outer = gather_points(x, batch.outer[c]);
    const Vector3<Lanes> inner = gather_points(x, batch.inner[c]);
    pieces.middle[c] = fill_lanes(0.5) * (outer + inner);
    pieces.distance[c] = outer - inner;
  }
  for (int g = 0; g < 2; ++g) {
    pieces.s[g] = batch.s[g];
    pieces.t[g] = batch.t[g];
  }
  for (int g = 0; g < 4; ++g) pieces.weight[g] = batch.weight[g];
  return pieces;
}

/// Adds a vector of each lane to the first numbers of its wall place, from `first` on.
LIPOFILL_INLINE void add_vectors(const Vector3<Lanes>& vectors, const int (&places)[kLanes], double* first) {
  Lanes rows[kLanes] = {vectors.x, vectors.y, vectors.z, Lanes{}};
  transpose(rows);
  for (int lane = 0; lane < kLanes; ++lane) add_to(rows[lane], first + 8 * static_cast<ptrdiff_t>(places[lane]));
}

void add_gradients(const GapGradient<Lanes>& gradient, const GapGeometry::Batch& batch, double* gradients) {
  for (int c = 0; c < 4; ++c) {
    const Vector3<Lanes> half = fill_lanes(0.5) * gradient.by_middle[c];
    add_vectors(half + gradient.by_distance[c], batch.wall_place[c], gradients);
    add_vectors(half - gradient.by_distance[c], batch.wall_place[c], gradients + 4);
  }
}

}  // namespace

GapVolume::GapVolume(const geometry::LayeredGrid& tissue, const WallNodes& walls, const film::FilmGrid& film,
                     const std::vector<int>& dof_of_component, int n_dofs)
    : GapVolume(std::make_shared<const GapGeometry>(make_gap_geometry(
          tissue, walls, film, film::cut_cells(film, tissue.n_xi, tissue.n_eta), dof_of_component, n_dofs))) {}

GapVolume::GapVolume(std::shared_ptr<const GapGeometry> geometry)
    : geometry_(std::move(geometry)),
      volume_(Eigen::VectorXd::Zero(geometry_->n_cells)),
      derivative_(geometry_->pattern),
      gradients_(8, geometry_->wall_places.size()) {}

void GapVolume::evaluate(const Eigen::Matrix3Xd& x) {
  integrate<true>(x);
  scatter_derivative();
}

void GapVolume::evaluate_volume(const Eigen::Matrix3Xd& x) {
  integrate<false>(x);
}

template <bool kWithDerivative>
void GapVolume::integrate(const Eigen::Matrix3Xd& x) {
  volume_.setZero();
  if (kWithDerivative) gradients_.setZero();
  for (const GapGeometry::Batch& batch : geometry_->batches) {
    GapGradient<Lanes> gradient;
    const Lanes volume = integrate_piece<kWithDerivative>(gather_pieces(batch, x.data()), &gradient);
    for (int lane = 0; lane < kLanes; ++lane) {
      if (batch.cell[lane] >= 0) volume_[batch.cell[lane]] += volume[lane];
    }
    if (kWithDerivative) add_gradients(gradient, batch, gradients_.data());
  }
}

/// Scatters the derivative of the outer wall, then of the inner: where the walls are bonded the two
/// go to the same value, and cancel where they cannot part.
void GapVolume::scatter_derivative() {
  derivative_.coeffs().setZero();
  double* const values = derivative_.valuePtr();
  const double* gradient = gradients_.data();
  for (const GapGeometry::WallPlace& place : geometry_->wall_places) {
    for (int c = 0; c < 3; ++c) {
      if (place.outer_slot[c] >= 0) values[place.outer_slot[c]] += gradient[c];
      if (place.inner_slot[c] >= 0) values[place.inner_slot[c]] += gradient[4 + c];
    }
    gradient += 8;
  }
}

void GapVolume::mid_surface(const Eigen::Matrix3Xd& x, Eigen::Matrix3Xd& vertices) const {
  vertices.resize(3, static_cast<Eigen::Index>(geometry_->vertices.size()));
  double* to = vertices.data();
  for (const GapGeometry::Vertex& vertex : geometry_->vertices) {
    for (int c = 0; c < 3; ++c, ++to) {
      *to = 0.0;
      for (int k = 0; k < 4; ++k) {
        *to += 0.5 * vertex.weight[k] * (x.data()[3 * vertex.outer[k] + c] + x.data()[3 * vertex.inner[k] + c]);
      }
    }
  }
}

Eigen::Matrix3Xd GapVolume::mid_surface(const Eigen::Matrix3Xd& x) const {
  Eigen::Matrix3Xd vertices;
  mid_surface(x, vertices);
  return vertices;
}

double compute_swept_volume(const geometry::LayeredGrid& grid, const Eigen::Matrix3Xd& rest,
                            const Eigen::Matrix3Xd& current) {
  const double low = 0.5 - 0.5 / std::sqrt(3.0);
  const auto point = [](const Eigen::Matrix3Xd& x, int place) {
    return Vector3<double>{x(0, place), x(1, place), x(2, place)};
  };
  double volume = 0.0;
  for (int j = 0; j < grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) {
      const int places[4] = {grid.surface_index(i, j), grid.surface_index(i + 1, j), grid.surface_index(i + 1, j + 1),
                             grid.surface_index(i, j + 1)};
      GapPiece<double> piece{{}, {}, {low, 1.0 - low}, {low, 1.0 - low}, {0.25, 0.25, 0.25, 0.25}};
      for (int c = 0; c < 4; ++c) {
        piece.middle[c] = 0.5 * (point(current, places[c]) + point(rest, places[c]));
        piece.distance[c] = point(current, places[c]) - point(rest, places[c]);
      }
      volume += integrate_piece<false>(piece, static_cast<GapGradient<double>*>(nullptr));
    }
  }
  return volume;
}

}  // namespace lipofill::coupling
