#include "core/solid/solid_shell.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/solid/element_batch.h"
#include "core/solid/enhanced_strain.h"

namespace lipofill::solid {
namespace {

constexpr int kDofs = 24;
constexpr int kModes = 7;
constexpr int kThickness = 2;  // Voigt row of strain 33
constexpr int kShear12 = 3;
constexpr int kShear23 = 4;
constexpr int kShear31 = 5;

using ShapeDerivatives = Eigen::Matrix<double, 8, 3>;
using Row = std::array<Lanes, kDofs>;  ///< of a strain, by degree of freedom
using Matrix6 = std::array<std::array<Lanes, 6>, 6>;

/// The element has the same points whatever its nodes are.
struct Point {
  explicit Point(const LocalPoint& place) : local(place), derivatives(compute_shape_derivatives(place)) {}
  LocalPoint local;
  ShapeDerivatives derivatives;
};

const std::array<Point, 8>& gauss_points() {
  static const std::array<Point, 8> points = [] {
    const std::array<LocalPoint, 8> x = hex_gauss_points();
    return std::array<Point, 8>{Point(x[0]), Point(x[1]), Point(x[2]), Point(x[3]),
                                Point(x[4]), Point(x[5]), Point(x[6]), Point(x[7])};
  }();
  return points;
}

// Sums of products go in the order in which Eigen takes those of enhanced_strain.h, so that both
// give the same bits: term by term, where rows go in pairs; the last of an odd number of rows by
// halves.

/// The sum of a(k) b(k), k < n, term by term.
template <int n, class A, class B>
LIPOFILL_INLINE Lanes sum_products(const A& a, const B& b) {
  Lanes sum = a(0) * b(0);
  for (int k = 1; k < n; ++k) sum = multiply_add(a(k), b(k), sum);
  return sum;
}
/// The same by halves, from k = first on.
template <int n, class A, class B>
LIPOFILL_INLINE Lanes sum_by_halves(const A& a, const B& b, int first = 0) {
  if constexpr (n == 1) {
    return a(first) * b(first);
  } else {
    return sum_by_halves<n / 2>(a, b, first) + sum_by_halves<n - n / 2>(a, b, first + n / 2);
  }
}

/// kLanes hexahedra at a place: their covariant base vectors G_j as columns of J.
struct Frame {
  Frame(const std::array<HexNodes, kLanes>& nodes, const ShapeDerivatives& dN) {
    for (int i = 0; i < 3; ++i) {
      const auto x = [&](int a) { return Lanes{nodes[0](i, a), nodes[1](i, a), nodes[2](i, a), nodes[3](i, a)}; };
      for (int j = 0; j < 3; ++j) {
        const auto slope = [&](int a) { return fill_lanes(dN(a, j)); };
        J.m[i][j] = i < 2 ? sum_products<8>(x, slope) : sum_by_halves<8>(x, slope);
      }
    }
  }

  /// G_i . dN/dxi_j, the row of strain ij where i = j.
  void set_row(int i, const ShapeDerivatives& dN, Row& row) const {
    for (int a = 0; a < 8; ++a) {
      for (int c = 0; c < 3; ++c) row[3 * a + c] = J.m[c][i] * dN(a, i);
    }
  }
  /// The row of the shear strain ij.
  void set_shear_row(int i, int j, const ShapeDerivatives& dN, Row& row) const {
    for (int a = 0; a < 8; ++a) {
      for (int c = 0; c < 3; ++c) row[3 * a + c] = J.m[c][i] * dN(a, j) + J.m[c][j] * dN(a, i);
    }
  }

  LaneMatrix3 J;
};

/// det J, and T of compute_strain_transform.
struct Transform {
  explicit Transform(const LaneMatrix3& J) {
    LaneMatrix3 A;  // A(i, k) = dxi_i/dX_k
    for (int lane = 0; lane < kLanes; ++lane) {
      Eigen::Matrix3d jacobian;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) jacobian(i, j) = J.m[i][j][lane];
      }
      volume[lane] = jacobian.determinant();
      const Eigen::Matrix3d inverse = jacobian.inverse();
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) A.m[i][j][lane] = inverse(i, j);
      }
    }
    for (int row = 0; row < 6; ++row) {
      const auto [k, l] = kVoigt[row];
      for (int column = 0; column < 6; ++column) {
        const auto [i, j] = kVoigt[column];
        T[row][column] = (row < 3 ? 0.5 : 1.0) * (A.m[i][k] * A.m[j][l] + A.m[j][k] * A.m[i][l]);
      }
    }
  }

  Lanes volume;
  Matrix6 T;
};

/// Strains at the tying points, interpolated anywhere in the element.
class AssumedStrains {
 public:
  explicit AssumedStrains(const std::array<HexNodes, kLanes>& nodes) {
    static const std::array<Point, 4> corners = {Point({-1, -1, 0}), Point({1, -1, 0}), Point({1, 1, 0}),
                                                 Point({-1, 1, 0})};
    static const std::array<Point, 2> sides_along_eta = {Point({0, -1, 0}), Point({0, 1, 0})};
    static const std::array<Point, 2> sides_along_xi = {Point({-1, 0, 0}), Point({1, 0, 0})};
    for (int c = 0; c < 4; ++c) {
      const ShapeDerivatives& dN = corners[c].derivatives;
      Frame(nodes, dN).set_row(2, dN, thickness_[c]);
      factors_[c] = corners[c].local;
    }
    for (int side = 0; side < 2; ++side) {
      const ShapeDerivatives& along_eta = sides_along_eta[side].derivatives;
      const ShapeDerivatives& along_xi = sides_along_xi[side].derivatives;
      Frame(nodes, along_eta).set_shear_row(2, 0, along_eta, shear31_[side]);
      Frame(nodes, along_xi).set_shear_row(1, 2, along_xi, shear23_[side]);
    }
  }

  /// Sets the transverse rows of the covariant B.
  void set_rows(const LocalPoint& point, std::array<Row, 6>& B) const {
    const double xi = point[0];
    const double eta = point[1];
    for (int d = 0; d < kDofs; ++d) {
      B[kShear31][d] = 0.5 * (1.0 - eta) * shear31_[0][d] + 0.5 * (1.0 + eta) * shear31_[1][d];
      B[kShear23][d] = 0.5 * (1.0 - xi) * shear23_[0][d] + 0.5 * (1.0 + xi) * shear23_[1][d];
      B[kThickness][d] = Lanes{};
      for (int c = 0; c < 4; ++c) {
        B[kThickness][d] += 0.25 * (1.0 + factors_[c][0] * xi) * (1.0 + factors_[c][1] * eta) * thickness_[c][d];
      }
    }
  }

 private:
  std::array<Row, 4> thickness_;
  std::array<LocalPoint, 4> factors_;
  std::array<Row, 2> shear31_;
  std::array<Row, 2> shear23_;
};

/// The Voigt row of each enhanced mode, and its value.
struct Mode {
  int row;
  double value;
};
std::array<Mode, kModes> find_modes(const LocalPoint& point) {
  const double xi = point[0];
  const double eta = point[1];
  const double zeta = point[2];
  return {{{0, xi},
           {1, eta},
           {kThickness, zeta},
           {kThickness, xi * zeta},
           {kThickness, eta * zeta},
           {kShear12, xi},
           {kShear12, eta}}};
}

/// D of isotropic materials: lambda + 2 mu, lambda, mu.
struct Elasticity {
  explicit Elasticity(const std::array<ElasticityMatrix, kLanes>& D) {
    for (int lane = 0; lane < kLanes; ++lane) {
      along[lane] = D[lane](0, 0);
      across[lane] = D[lane](0, 1);
      shear[lane] = D[lane](3, 3);
    }
  }
  /// e^T D of a strain e.
  std::array<Lanes, 6> stress_of(const Lanes& e0, const Lanes& e1, const Lanes& e2, const Lanes& e3, const Lanes& e4,
                                 const Lanes& e5) const {
    return {(e0 * along + e2 * across) + e1 * across,
            (e0 * across + e2 * across) + e1 * along,
            (e0 * across + e2 * along) + e1 * across,
            e3 * shear,
            e4 * shear,
            e5 * shear};
  }

  Lanes along, across, shear;
};

/// The sums over the Gauss points of compute_enhanced_stiffness.
struct Sums {
  std::array<Row, kDofs> uu{};
  std::array<Row, kModes> au{};
  std::array<std::array<Lanes, kModes>, kModes> aa{};

  /// K = Kuu - Kua Kaa^-1 Kau of a lane.
  HexStiffness condense(int lane) const {
    HexStiffness Kuu;
    Eigen::Matrix<double, kModes, kDofs> Kau;
    Eigen::Matrix<double, kModes, kModes> Kaa;
    for (int i = 0; i < kDofs; ++i) {
      for (int j = 0; j < kDofs; ++j) Kuu(i, j) = uu[i][j][lane];
    }
    for (int i = 0; i < kModes; ++i) {
      for (int j = 0; j < kDofs; ++j) Kau(i, j) = au[i][j][lane];
      for (int j = 0; j < kModes; ++j) Kaa(i, j) = aa[i][j][lane];
    }
    const HexStiffness K = Kuu - Kau.transpose() * Kaa.ldlt().solve(Kau);
    return 0.5 * (K + K.transpose());
  }
};

/// Adds volume B^T D B.
void add_displacements(const std::array<Row, 6>& B, const Elasticity& D, const Lanes& volume, Sums& sums) {
  for (int i = 0; i < kDofs; ++i) {
    const std::array<Lanes, 6> s = D.stress_of(B[0][i], B[1][i], B[2][i], B[3][i], B[4][i], B[5][i]);
    for (int j = 0; j < kDofs; ++j) {
      sums.uu[i][j] += volume * sum_products<6>([&](int k) { return s[k]; }, [&](int k) { return B[k][j]; });
    }
  }
}

/// Adds volume G^T D B and volume G^T D G; mode k of G is a column of det J0/det J T0 times its
/// value.
void add_modes(const std::array<Row, 6>& B, const Transform& centre, const LocalPoint& point, const Elasticity& D,
               const Lanes& volume, Sums& sums) {
  const std::array<Mode, kModes> modes = find_modes(point);
  const Lanes share = centre.volume / volume;
  std::array<std::array<Lanes, 6>, kModes> G;
  for (int k = 0; k < kModes; ++k) {
    for (int row = 0; row < 6; ++row) G[k][row] = share * centre.T[row][modes[k].row] * modes[k].value;
  }
  for (int i = 0; i < kModes; ++i) {
    const std::array<Lanes, 6>& g = G[i];
    const std::array<Lanes, 6> s =
        D.stress_of(volume * g[0], volume * g[1], volume * g[2], volume * g[3], volume * g[4], volume * g[5]);
    const auto stress = [&](int k) { return s[k]; };
    const auto sum = [&](const auto& strain) {
      return i + 1 < kModes ? sum_products<6>(stress, strain) : sum_by_halves<6>(stress, strain);
    };
    for (int j = 0; j < kDofs; ++j) sums.au[i][j] += sum([&](int k) { return B[k][j]; });
    for (int j = 0; j < kModes; ++j) sums.aa[i][j] += sum([&](int k) { return G[j][k]; });
  }
}

}  // namespace

void compute_solid_shell_stiffness(const std::array<HexNodes, kLanes>& nodes,
                                   const std::array<ElasticityMatrix, kLanes>& elasticity,
                                   std::array<HexStiffness, kLanes>& stiffness) {
  static const Point middle(LocalPoint::Zero());
  const Elasticity D(elasticity);
  const AssumedStrains assumed(nodes);
  const Transform centre(Frame(nodes, middle.derivatives).J);
  Sums sums;
  for (const Point& point : gauss_points()) {
    const Frame frame(nodes, point.derivatives);
    const Transform transform(frame.J);
    std::array<Row, 6> covariant, B;
    frame.set_row(0, point.derivatives, covariant[0]);
    frame.set_row(1, point.derivatives, covariant[1]);
    frame.set_shear_row(0, 1, point.derivatives, covariant[kShear12]);
    assumed.set_rows(point.local, covariant);
    for (int i = 0; i < 6; ++i) {
      for (int d = 0; d < kDofs; ++d) {
        B[i][d] = sum_products<6>([&](int k) { return transform.T[i][k]; }, [&](int k) { return covariant[k][d]; });
      }
    }
    add_displacements(B, D, transform.volume, sums);
    add_modes(B, centre, point.local, D, transform.volume, sums);
  }
  for (int lane = 0; lane < kLanes; ++lane) stiffness[lane] = sums.condense(lane);
}

HexStiffness compute_solid_shell_stiffness(const HexNodes& nodes, const ElasticityMatrix& elasticity) {
  std::array<HexStiffness, kLanes> stiffness;
  compute_solid_shell_stiffness({nodes, nodes, nodes, nodes}, {elasticity, elasticity, elasticity, elasticity},
                                stiffness);
  return stiffness[0];
}

}  // namespace lipofill::solid
