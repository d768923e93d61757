#include "core/step/step_memory.h"

namespace lipofill::step {
namespace {

/// Memory of the factor with what making it takes, of matrices with their scatter maps, and of the
/// vectors of steps, states and frames. Measured: 22 MB a simulation of jaw_angle, reckoned 24; 150
/// MB at four times its size, reckoned 124.
constexpr uint64_t kBytesAFactorValue = 8;
constexpr uint64_t kBytesAValue = 24;
constexpr uint64_t kBytesADof = 600;
constexpr uint64_t kBytesACell = 4000;

}  // namespace

uint64_t estimate_memory(int n_cells, const mechanics::TissueSystem* system, const mechanics::HeldFactor* factor) {
  const uint64_t of_cells = static_cast<uint64_t>(n_cells) * kBytesACell;
  if (factor == nullptr) return of_cells;
  const Eigen::SparseMatrix<double>& b = system->gaps().derivative();
  const uint64_t n_dense = factor->has_compliance() ? static_cast<uint64_t>(b.rows()) : 0;
  const auto n_values = static_cast<uint64_t>(system->tissue().system_matrix().nonZeros() + b.nonZeros());
  const auto n_dofs = static_cast<uint64_t>(system->tissue().n_dofs());
  return kBytesAFactorValue * static_cast<uint64_t>(factor->factor().analysis().n_values()) +
         sizeof(double) * n_dense * n_dense + n_values * kBytesAValue + n_dofs * kBytesADof + of_cells;
}

}  // namespace lipofill::step
