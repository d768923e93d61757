#pragma once

#include <Eigen/Core>

#include "core/film/edge_operators.h"
#include "core/film/film_grid.h"
#include "core/film/film_metric.h"
#include "core/film/rheology.h"

namespace lipofill::film {

/// Flux through every open edge, F(D), as a function of what drives the fat across it, D = rho
/// b . dX - G p [Pa].
///
///     F = W(k) D                                      Newtonian fat: linear, with inertia
///     F = f(|grad|) w D + W(h^3/(12 G dt)) (D - s)    other fat, a quadrant at a time
///
/// with k of compute_conductance, w the form of the conductance h^3/(12 K), f of
/// compute_flow_factor at the quadrant's own gradient, |grad|^2 = D^T w D / (c h^3),
/// c = sqrt(g)/(48 K), its thickness h = (h1^2 + h2^2)/(h1 + h2) of its two edges; the second term
/// is the Maxwell element, one implicit step of rate = stress/viscous + d(stress)/dt/G, s the
/// friction of the last step. F is the gradient of a convex function of D: its tangent is symmetric
/// and positive semi-definite. Flow below the yield stress is zero, not small.
///
/// After the first step nothing is allocated. Checked by tests/unit/film/rheology_test.cc.
class FlowLaw {
 public:
  explicit FlowLaw(const FilmGrid& grid) : grid_(&grid) {}

  /// Computes everything that stays constant through a step. `metric` must outlive the step.
  void begin_step(const FilmMetric& metric, const Fat& fat, double dt);

  /// @param edge_thickness  h [m] (n_edges), 0: dry or closed
  /// @param wall_stress     T = h s / 2 of the last step [Pa m] (n_edges), elastic fat only
  void set_thickness(const Eigen::VectorXd& edge_thickness, const Eigen::VectorXd& wall_stress);

  bool is_linear() const { return fat_.is_newtonian(); }
  /// Adds F(D) to `flux` (n_edges).
  void add_flux(const Eigen::VectorXd& drive, Eigen::Ref<Eigen::VectorXd> flux);
  /// dF/dD as forms [m3/(Pa s)]. Where nothing flows it stays just above zero, so that a pressure
  /// follows.
  const QuadrantForms& linearise(const Eigen::VectorXd& drive);

 private:
  /// A quadrant's reference form, scale and thickness, for the flow factor.
  struct Quadrant {
    QuadrantForm form;
    double gradient_scale = 0.0;  ///< 1/(c h^3)
    double thickness = 0.0;
  };
  struct Response;
  Response respond(const Quadrant& quadrant, const QuadrantEdges& edges, const double* drive) const;
  void set_quadrants(const Eigen::VectorXd& edge_thickness);
  void set_elastic_part(const Eigen::VectorXd& edge_thickness, const Eigen::VectorXd& wall_stress);
  template <typename OfThickness>
  void scale_by(const Eigen::VectorXd& edge_thickness, OfThickness conductance, QuadrantForms& forms);

  const FilmGrid* grid_;
  const FilmMetric* metric_ = nullptr;
  Fat fat_;
  double dt_ = 0.0;
  QuadrantForms unit_;                              ///< W(1) of the step's metric
  QuadrantForms linear_;                            ///< it holds W(k) where there is inertia, else the elastic part
  QuadrantForms reference_;                         ///< W(h^3/(12 K)), without inertia
  QuadrantForms tangent_;                           ///< without inertia
  std::vector<std::array<Quadrant, 4>> quadrants_;  ///< empty: with inertia
  Eigen::VectorXd elastic_start_;                   ///< s [Pa], 0 without elasticity
  Eigen::VectorXd beyond_start_;                    ///< D - s [Pa]
  Eigen::VectorXd conductance_, root_;
};

}  // namespace lipofill::film
