#pragma once

#include <Eigen/Core>

#include "core/film/film_grid.h"

namespace lipofill::film {

/// Film thickness at every open edge, reconstructed from the side the fat comes from:
///
///     h_e = h_u + 1/2 s,   s = 2 a b / (a + b) if a b > 0, else 0,   a = h_d - h_u,  b = h_u - h_uu
///
/// with u the upstream cell, d the one downstream, uu the one behind u (van Leer's limiter; without
/// uu, s = 0). Second order where h is smooth and monotone. As 0 <= h_e <= 2 h_u, no more can flow
/// out of a cell than it holds: the thickness stays positive at any step.
///
/// @param h     film thickness [m] (n_cells), each >= 0
/// @param flux  its sign tells which cell is upstream (n_edges, or more); 0 counts as from left to
///              right
/// Checked by tests/unit/film/edge_operators_test.cc.
void compute_edge_thickness(const FilmGrid& grid, const Eigen::Ref<const Eigen::VectorXd>& h,
                            const Eigen::Ref<const Eigen::VectorXd>& flux, Eigen::VectorXd& thickness);
Eigen::VectorXd compute_edge_thickness(const FilmGrid& grid, const Eigen::Ref<const Eigen::VectorXd>& h,
                                       const Eigen::Ref<const Eigen::VectorXd>& flux);

}  // namespace lipofill::film
