#include "core/solid/tissue_checks.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/solid/hex_shape.h"

namespace lipofill::solid {
namespace {

// A mesh can be wrong everywhere; a message need not be.
constexpr int kMaxReports = 5;
constexpr double kWeightTolerance = 1e-9;

void check_size(const char* field, size_t size, int expected, FieldViolations& violations) {
  if (size == static_cast<size_t>(expected)) return;
  violations.add(field, absl::StrCat("has ", size, " entries, must have ", expected));
}

void check_sizes(const HexMesh& mesh, const NodeSupports& supports, FieldViolations& violations) {
  check_size("mesh.material", mesh.material.size(), mesh.n_hexahedra(), violations);
  check_size("mesh.stacked", mesh.stacked.size(), mesh.n_hexahedra(), violations);
  check_size("supports.fixed", supports.fixed.size(), mesh.n_nodes(), violations);
  check_size("supports.spring", supports.spring.size(), mesh.n_nodes(), violations);
}

void check_indices(const HexMesh& mesh, int n_materials, FieldViolations& violations) {
  int reports = 0;
  const auto check_index = [&](const char* what, int e, int index, int count) {
    if ((index >= 0 && index < count) || ++reports > kMaxReports) return;
    violations.add(absl::StrCat("mesh.hexahedra[", e, "]"),
                   absl::StrCat("has ", what, " ", index, ", must be in [0, ", count, ")"));
  };
  for (int e = 0; e < mesh.n_hexahedra(); ++e) {
    for (int a : mesh.hexahedra[e]) check_index("node", e, a, mesh.n_nodes());
    check_index("material", e, mesh.material[e], n_materials);
  }
}

/// A node of no hexahedron has neither mass nor stiffness: S would be singular, unless the node is
/// held.
void check_nodes(const HexMesh& mesh, const NodeSupports& supports, FieldViolations& violations) {
  std::vector<bool> used(mesh.n_nodes(), false);
  for (const auto& hexahedron : mesh.hexahedra) {
    for (int a : hexahedron) used[a] = true;
  }
  for (size_t a = 0; a < supports.fixed.size() && a < used.size(); ++a) {
    const std::array<bool, 3>& held = supports.fixed[a];
    if (held[0] && held[1] && held[2]) used[a] = true;
  }
  int reports = 0;
  for (int a = 0; a < mesh.n_nodes(); ++a) {
    const bool finite = mesh.rest_positions.col(a).allFinite();
    if ((finite && used[a]) || ++reports > kMaxReports) continue;
    violations.add(absl::StrCat("mesh.rest_positions[", a, "]"),
                   finite ? "belongs to no hexahedron" : "must be finite");
  }
}

double compute_min_jacobian(const HexNodes& nodes) {
  double least = compute_jacobian(nodes, LocalPoint::Zero()).determinant();
  const HexNodes corners = hex_corners();
  const std::array<LocalPoint, 8> gauss_points = hex_gauss_points();
  for (int q = 0; q < 8; ++q) {
    least = std::min(least, compute_jacobian(nodes, corners.col(q)).determinant());
    least = std::min(least, compute_jacobian(nodes, gauss_points[q]).determinant());
  }
  return least;
}

void check_shapes(const HexMesh& mesh, FieldViolations& violations) {
  int reports = 0;
  for (int e = 0; e < mesh.n_hexahedra(); ++e) {
    const HexNodes nodes = mesh.gather(e, mesh.rest_positions);
    const double jacobian = compute_min_jacobian(nodes);
    if (jacobian > 0.0 || ++reports > kMaxReports) continue;
    const Eigen::Vector3d centre = nodes.rowwise().mean();
    violations.add(absl::StrCat("mesh.hexahedra[", e, "]"),
                   absl::StrCat("around (", centre[0], ", ", centre[1], ", ", centre[2], ") m has Jacobian ", jacobian,
                                " m3, must be greater than 0"));
  }
}

void check_springs(const NodeSupports& supports, FieldViolations& violations) {
  int reports = 0;
  for (size_t a = 0; a < supports.spring.size(); ++a) {
    const double spring = supports.spring[a];
    if ((std::isfinite(spring) && spring >= 0.0) || ++reports > kMaxReports) continue;
    violations.add(absl::StrCat("supports.spring[", a, "]"),
                   absl::StrCat("is ", spring, " N/m, must be finite and at least 0"));
  }
}

bool is_on_nodes(const WallSpring& spring, int n_nodes) {
  const auto exists = [n_nodes](int a) { return a >= 0 && a < n_nodes; };
  return std::all_of(spring.outer.begin(), spring.outer.end(), exists) &&
         std::all_of(spring.inner.begin(), spring.inner.end(), exists);
}

std::string find_fault(const WallSpring& spring, int n_nodes) {
  if (!is_on_nodes(spring, n_nodes)) return absl::StrCat("has a node out of [0, ", n_nodes, ")");
  const double sum = spring.weight[0] + spring.weight[1] + spring.weight[2] + spring.weight[3];
  if (!(std::abs(sum - 1.0) <= kWeightTolerance))
    return absl::StrCat("has weights that add up to ", sum, ", must be 1");
  if (!std::isfinite(spring.stiffness) || spring.stiffness <= 0.0) {
    return absl::StrCat("has stiffness ", spring.stiffness, " N/m, must be finite and greater than 0");
  }
  if (!std::isfinite(spring.slack) || spring.slack < 0.0) {
    return absl::StrCat("has slack ", spring.slack, " m, must be finite and at least 0");
  }
  return "";
}

void check_wall_springs(const std::vector<WallSpring>& springs, int n_nodes, FieldViolations& violations) {
  int reports = 0;
  for (size_t s = 0; s < springs.size(); ++s) {
    const std::string fault = find_fault(springs[s], n_nodes);
    if (fault.empty() || ++reports > kMaxReports) continue;
    violations.add(absl::StrCat("springs[", s, "]"), fault);
  }
}

void check_damping(const char* field, double value, const char* unit, FieldViolations& violations) {
  if (std::isfinite(value) && value >= 0.0) return;
  violations.add(field, absl::StrCat("is ", value, " ", unit, ", must be finite and at least 0"));
}

}  // namespace

absl::Status check_tissue(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials,
                          const NodeSupports& supports, const std::vector<WallSpring>& springs) {
  FieldViolations violations;
  for (size_t m = 0; m < materials.size(); ++m) {
    check_material(absl::StrCat("materials[", m, "]"), materials[m], violations);
  }
  check_sizes(mesh, supports, violations);
  check_springs(supports, violations);
  check_wall_springs(springs, mesh.n_nodes(), violations);
  if (!violations.empty()) return violations.to_status();
  check_indices(mesh, static_cast<int>(materials.size()), violations);
  if (!violations.empty()) return violations.to_status();
  check_nodes(mesh, supports, violations);
  if (violations.empty()) check_shapes(mesh, violations);
  return violations.to_status();
}

absl::Status check_youngs_moduli(const std::vector<double>& youngs_moduli, int n_materials) {
  FieldViolations violations;
  check_size("youngs_moduli", youngs_moduli.size(), n_materials, violations);
  for (size_t m = 0; m < youngs_moduli.size(); ++m) {
    if (std::isfinite(youngs_moduli[m]) && youngs_moduli[m] > 0.0) continue;
    violations.add(absl::StrCat("youngs_moduli[", m, "]"),
                   absl::StrCat("is ", youngs_moduli[m], " Pa, must be finite and greater than 0"));
  }
  return violations.to_status();
}

absl::Status check_damping(const RayleighDamping& damping) {
  FieldViolations violations;
  check_damping("damping.alpha", damping.alpha, "1/s", violations);
  check_damping("damping.beta", damping.beta, "s", violations);
  return violations.to_status();
}

}  // namespace lipofill::solid
