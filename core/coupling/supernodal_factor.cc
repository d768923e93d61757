#include "core/coupling/supernodal_factor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/coupling/algebra_threads.h"
#include "core/coupling/blas.h"
#include "core/coupling/panel_solve.h"
#include "core/coupling/panel_solve_many.h"

namespace lipofill::coupling {

namespace {

/// Supernodes with more than this share of all pressures are squared together, so many columns at a
/// time: one by one the additions would cost more than the multiplications.
constexpr double kGatheredShare = 0.4;
constexpr int kGatheredColumns = 256;

}  // namespace

using Sparse = Eigen::SparseMatrix<double>;

template <typename Scalar>
SupernodalFactor<Scalar>::SupernodalFactor(std::shared_ptr<const FactorAnalysis> analysis)
    : analysis_(std::move(analysis)),
      values_(analysis_->n_values() + PanelSolve<Scalar>::kPadding),
      buffer_(static_cast<size_t>(analysis_->max_rows()) * analysis_->max_columns() + PanelSolve<Scalar>::kPadding),
      position_(analysis_->n_dofs() + analysis_->n_cells()),
      relative_(analysis_->max_rows()),
      scale_(analysis_->n_dofs()),
      forward_(analysis_->n_dofs() + analysis_->n_cells()),
      solution_(analysis_->n_dofs() + analysis_->n_cells()) {}

/// Fills L with the scaled values of S and B; false for a diagonal that is not positive, or not a
/// number.
template <typename Scalar>
bool SupernodalFactor<Scalar>::fill(const Sparse& s, const Sparse& b) {
  for (int k = 0; k < s.cols(); ++k) {
    const double diagonal = s.valuePtr()[s.outerIndexPtr()[k]];
    if (!(diagonal > 0.0)) return false;
    scale_[k] = 1.0 / std::sqrt(diagonal);
  }
  double largest = 0.0;
  for (int column = 0; column < b.cols() && analysis_->n_cells() > 0; ++column) {
    for (Sparse::InnerIterator it(b, column); it; ++it) {
      largest = std::max(largest, std::abs(it.value()) * scale_[column]);
    }
  }
  pressure_scale_ = largest > 0.0 ? 1.0 / largest : 1.0;
  std::fill(values_.begin(), values_.end(), Scalar(0));
  const std::int64_t* target = analysis_->target_of_s().data();
  for (int column = 0; column < s.cols(); ++column) {
    for (Sparse::InnerIterator it(s, column); it; ++it) {
      values_[*target++] = static_cast<Scalar>(it.value() * scale_[it.row()] * scale_[column]);
    }
  }
  target = analysis_->target_of_b().data();
  for (int column = 0; column < b.cols() && analysis_->n_cells() > 0; ++column) {
    for (Sparse::InnerIterator it(b, column); it; ++it) {
      values_[*target++] = static_cast<Scalar>(it.value() * scale_[column] * pressure_scale_);
    }
  }
  return true;
}

template <typename Scalar>
bool SupernodalFactor<Scalar>::factorise(const Sparse& s, const Sparse& b) {
  pin_algebra_to_this_thread();
  if (!fill(s, b)) return false;
  for (size_t k = 0; k < analysis_->supernodes().size(); ++k) {
    const Supernode& node = analysis_->supernodes()[k];
    const int* rows = analysis_->rows().data() + node.rows;
    for (int r = 0; r < node.n_rows; ++r) position_[rows[r]] = r;
    for (const FactorAnalysis::Update& update : analysis_->updates(static_cast<int>(k))) subtract_update(node, update);
    Scalar* panel = values_of(node);
    if (!blas::factor_lower(node.n_columns, panel, node.n_rows)) return false;
    const Scalar last_pivot = panel[(node.n_columns - 1) * (static_cast<std::int64_t>(node.n_rows) + 1)];
    if (!(last_pivot > Scalar(0))) return false;
    const int below = node.n_rows - node.n_columns;
    if (below > 0) {
      blas::solve_right_transposed(below, node.n_columns, panel, node.n_rows, panel + node.n_columns, node.n_rows);
    }
    PanelSolve<Scalar>::invert_diagonal(panel, node.n_rows, node.n_columns);
  }
  return true;
}

/// Panel of `target` <- panel - L[begin.., :] L[begin..end, :]^T of the source, row by row where
/// they belong.
template <typename Scalar>
void SupernodalFactor<Scalar>::subtract_update(const Supernode& target, const FactorAnalysis::Update& update) {
  const Supernode& source = analysis_->supernodes()[update.source];
  const int* rows = analysis_->rows().data() + source.rows;
  const int m = source.n_rows - update.begin;
  const int n = update.end - update.begin;
  for (int r = 0; r < m; ++r) relative_[r] = position_[rows[update.begin + r]];
  const Scalar* from = values_of(source) + update.begin;
  Scalar* panel = values_of(target);
  const bool is_contiguous = relative_[m - 1] - relative_[0] == m - 1;
  if (is_contiguous) {
    Scalar* into = panel + static_cast<std::int64_t>(relative_[0]) * target.n_rows + relative_[0];
    blas::gemm_nt(m, n, source.n_columns, Scalar(-1), from, source.n_rows, from, source.n_rows, Scalar(1), into,
                  target.n_rows);
    return;
  }
  blas::gemm_nt(m, n, source.n_columns, Scalar(1), from, source.n_rows, from, source.n_rows, Scalar(0), buffer_.data(),
                m);
  for (int c = 0; c < n; ++c) {
    Scalar* column = panel + static_cast<std::int64_t>(relative_[c]) * target.n_rows;
    const Scalar* product = buffer_.data() + static_cast<std::int64_t>(c) * m;
    for (int r = c; r < m; ++r) column[relative_[r]] -= product[r];
  }
}

template <typename Scalar>
void SupernodalFactor<Scalar>::compute_compliance(Eigen::MatrixXd& compliance) {
  const int n_cells = analysis_->n_cells();
  sum_.setZero(n_cells, n_cells);
  gathered_.resize(n_cells, kGatheredColumns);
  int n_gathered = 0;
  for (const Supernode& node : analysis_->supernodes()) {
    const int n = node.n_rows - node.n_tissue_rows;
    if (n < kGatheredShare * n_cells) {
      add_square(node);
      continue;
    }
    for (int done = 0; done < node.n_columns;) {
      const int count = std::min(node.n_columns - done, kGatheredColumns - n_gathered);
      gather_pressure_rows(node, done, count, n_gathered);
      done += count;
      n_gathered += count;
      if (n_gathered == kGatheredColumns) add_gathered_squares(n_gathered);
    }
  }
  add_gathered_squares(n_gathered);
  compliance.resize(n_cells, n_cells);
  const double unscale = 1.0 / (pressure_scale_ * pressure_scale_);
  for (int c = 0; c < n_cells; ++c) {
    for (int r = c; r < n_cells; ++r) compliance(r, c) = compliance(c, r) = unscale * static_cast<double>(sum_(r, c));
  }
}

/// Adds the square of a supernode with few pressures.
template <typename Scalar>
void SupernodalFactor<Scalar>::add_square(const Supernode& node) {
  const int n = node.n_rows - node.n_tissue_rows;
  if (n == 0) return;
  const int* cells = analysis_->rows().data() + node.rows + node.n_tissue_rows;
  square_.resize(std::max<size_t>(square_.size(), static_cast<size_t>(n) * n));
  blas::syrk_lower(n, node.n_columns, Scalar(1), values_of(node) + node.n_tissue_rows, node.n_rows, Scalar(0),
                   square_.data(), n);
  for (int c = 0; c < n; ++c) {
    Scalar* column = sum_.data() + static_cast<std::int64_t>(cells[c] - analysis_->n_dofs()) * analysis_->n_cells();
    const Scalar* from = square_.data() + static_cast<std::int64_t>(c) * n;
    for (int r = c; r < n; ++r) column[cells[r] - analysis_->n_dofs()] += from[r];
  }
}

/// Columns [first, first + count) of a supernode's pressure rows, over all cells, into gathered_
/// from `at` on.
template <typename Scalar>
void SupernodalFactor<Scalar>::gather_pressure_rows(const Supernode& node, int first, int count, int at) {
  const int n = node.n_rows - node.n_tissue_rows;
  const int* cells = analysis_->rows().data() + node.rows + node.n_tissue_rows;
  gathered_.middleCols(at, count).setZero();
  for (int c = 0; c < count; ++c) {
    const Scalar* from = values_of(node) + static_cast<std::int64_t>(first + c) * node.n_rows + node.n_tissue_rows;
    for (int r = 0; r < n; ++r) gathered_(cells[r] - analysis_->n_dofs(), at + c) = from[r];
  }
}

template <typename Scalar>
void SupernodalFactor<Scalar>::add_gathered_squares(int& n_gathered) {
  const int n = analysis_->n_cells();
  if (n_gathered > 0 && n > 0) {
    blas::syrk_lower(n, n_gathered, Scalar(1), gathered_.data(), n, Scalar(1), sum_.data(), n);
  }
  n_gathered = 0;
}

template <typename Scalar>
void SupernodalFactor<Scalar>::solve_forward(const Eigen::VectorXd& r, Eigen::VectorXd& gap_response) {
  pin_algebra_to_this_thread();
  const int n_dofs = analysis_->n_dofs();
  for (int k = 0; k < n_dofs; ++k) {
    const int dof = analysis_->order()[k];
    forward_[k] = static_cast<Scalar>(r[dof] * scale_[dof]);
  }
  forward_.tail(analysis_->n_cells()).setZero();
  for (const Supernode& node : analysis_->supernodes()) {
    const int* rows = analysis_->rows().data() + node.rows;
    const int below = node.n_rows - node.n_columns;
    Scalar* t = buffer_.data();
    std::copy_n(forward_.data() + node.first_column, node.n_columns, t);
    std::fill_n(t + node.n_columns, below, Scalar(0));
    PanelSolve(values_of(node), node.n_rows, node.n_columns).forward(t);
    std::copy_n(t, node.n_columns, forward_.data() + node.first_column);
    for (int k = node.n_columns; k < node.n_rows; ++k) forward_[rows[k]] += t[k];
  }
  gap_response = -forward_.tail(analysis_->n_cells()).template cast<double>() / pressure_scale_;
}

template <typename Scalar>
void SupernodalFactor<Scalar>::solve_backward(const Eigen::VectorXd& pressure, Eigen::VectorXd& x) {
  pin_algebra_to_this_thread();
  const int n_dofs = analysis_->n_dofs();
  solution_.head(n_dofs) = forward_.head(n_dofs);
  solution_.tail(analysis_->n_cells()) = -(pressure / pressure_scale_).template cast<Scalar>();
  for (auto node = analysis_->supernodes().rbegin(); node != analysis_->supernodes().rend(); ++node) {
    const int* rows = analysis_->rows().data() + node->rows;
    Scalar* t = buffer_.data();
    for (int k = 0; k < node->n_rows; ++k) t[k] = solution_[rows[k]];
    std::fill_n(t + node->n_rows, PanelSolve<Scalar>::kPadding, Scalar(0));
    PanelSolve(values_of(*node), node->n_rows, node->n_columns).backward(t);
    std::copy_n(t, node->n_columns, solution_.data() + node->first_column);
  }
  x.resize(n_dofs);
  for (int k = 0; k < n_dofs; ++k) {
    const int dof = analysis_->order()[k];
    x[dof] = static_cast<double>(solution_[k]) * scale_[dof];
  }
}

/// All groups go through a supernode while it is near.
template <typename Scalar>
void SupernodalFactor<Scalar>::solve_many(const Eigen::MatrixXd& r, Eigen::MatrixXd& x) {
  constexpr int kWidth = PanelSolveMany<Scalar>::kWidth;
  const int n_dofs = analysis_->n_dofs(), n_rows = n_dofs + analysis_->n_cells();
  const auto n = static_cast<int>(r.cols());
  const int n_groups = (n + kWidth - 1) / kWidth;
  many_.assign(static_cast<size_t>(n_groups) * n_rows * kWidth, Scalar(0));
  many_buffer_.resize(static_cast<size_t>(analysis_->max_rows()) * kWidth);
  const auto place = [&](int row, int c) {
    return (static_cast<size_t>(c / kWidth) * n_rows + row) * kWidth + static_cast<size_t>(c % kWidth);
  };
  for (int k = 0; k < n_dofs; ++k) {
    const int dof = analysis_->order()[k];
    for (int c = 0; c < n; ++c) many_[place(k, c)] = static_cast<Scalar>(r(dof, c) * scale_[dof]);
  }
  solve_many_forward(n_groups);
  for (int k = n_dofs; k < n_rows; ++k) {
    for (int c = 0; c < n_groups * kWidth; ++c) many_[place(k, c)] = Scalar(0);
  }
  solve_many_backward(n_groups);
  x.resize(n_dofs, n);
  for (int k = 0; k < n_dofs; ++k) {
    const int dof = analysis_->order()[k];
    for (int c = 0; c < n; ++c) x(dof, c) = static_cast<double>(many_[place(k, c)]) * scale_[dof];
  }
}

template <typename Scalar>
void SupernodalFactor<Scalar>::solve_many_forward(int n_groups) {
  constexpr int kWidth = PanelSolveMany<Scalar>::kWidth;
  const std::ptrdiff_t group_size = static_cast<std::ptrdiff_t>(analysis_->n_dofs() + analysis_->n_cells()) * kWidth;
  Scalar* const t = many_buffer_.data();
  for (const Supernode& node : analysis_->supernodes()) {
    const int* rows = analysis_->rows().data() + node.rows;
    for (int g = 0; g < n_groups; ++g) {
      Scalar* const group = many_.data() + g * group_size;
      Scalar* const top = group + static_cast<std::ptrdiff_t>(node.first_column) * kWidth;
      std::copy_n(top, node.n_columns * kWidth, t);
      std::fill_n(t + node.n_columns * kWidth, (node.n_rows - node.n_columns) * kWidth, Scalar(0));
      PanelSolveMany<Scalar>(values_of(node), node.n_rows, node.n_columns).forward(t);
      std::copy_n(t, node.n_columns * kWidth, top);
      for (int k = node.n_columns; k < node.n_rows; ++k) {
        Scalar* const below = group + static_cast<std::ptrdiff_t>(rows[k]) * kWidth;
        for (int c = 0; c < kWidth; ++c) below[c] += t[k * kWidth + c];
      }
    }
  }
}

template <typename Scalar>
void SupernodalFactor<Scalar>::solve_many_backward(int n_groups) {
  constexpr int kWidth = PanelSolveMany<Scalar>::kWidth;
  const std::ptrdiff_t group_size = static_cast<std::ptrdiff_t>(analysis_->n_dofs() + analysis_->n_cells()) * kWidth;
  Scalar* const t = many_buffer_.data();
  for (auto node = analysis_->supernodes().rbegin(); node != analysis_->supernodes().rend(); ++node) {
    const int* rows = analysis_->rows().data() + node->rows;
    for (int g = 0; g < n_groups; ++g) {
      Scalar* const group = many_.data() + g * group_size;
      for (int k = 0; k < node->n_rows; ++k) {
        std::copy_n(group + static_cast<std::ptrdiff_t>(rows[k]) * kWidth, kWidth, t + k * kWidth);
      }
      PanelSolveMany<Scalar>(values_of(*node), node->n_rows, node->n_columns).backward(t);
      std::copy_n(t, node->n_columns * kWidth, group + static_cast<std::ptrdiff_t>(node->first_column) * kWidth);
    }
  }
}

template class SupernodalFactor<float>;
template class SupernodalFactor<double>;

}  // namespace lipofill::coupling
