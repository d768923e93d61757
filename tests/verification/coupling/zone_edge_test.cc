// The edge of a zone under a thin plate: where it lies between the grid's lines, and what an
// attachment around it gives, with and without fat in it.

#include <Eigen/SparseLU>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ScalarField;

constexpr double kSide = 0.04;
constexpr double kThickness = 0.5e-3;
constexpr double kYoungsModulus = 2e5;
constexpr double kNu = 0.45;
constexpr double kD = kYoungsModulus * kThickness * kThickness * kThickness / (12.0 * (1.0 - kNu * kNu));
/// Middle of the plate in units of its thickness: the linear range.
constexpr double kLift = kThickness / 500.0;

/// A plate on bone, n elements along xi and 4 along eta, whose sides move in their planes only:
/// cylindrical bending.
std::shared_ptr<const model::FaceModel> make_plate(int n) {
  model::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{kSide, 4 * kSide / n};
  spec.n_xi = n;
  spec.n_eta = 4;
  spec.layers = {{"plate", {ScalarField::constant(kThickness), 1}, {kYoungsModulus, kNu, 1100.0}}};
  spec.rim.kind = model::SupportKind::kRollers;
  auto model = model::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return *model;
}

struct AtRest {
  double pressure = 0.0;  ///< [Pa]
  double lift = 0.0;      ///< of the middle [m]
};

/// @param half  of the zone's length [m]
/// @param volume  a metre of width [m2]
AtRest inflate(int n, double half, double volume, const plan::ZoneEdgeSpec& edge) {
  const double width = 4 * kSide / n;
  plan::SimulationSpec spec;
  spec.films = {make_film(plan::FilmWallKind::kTissue, n / 2, 2)};
  spec.films[0].below_layer = "plate";
  spec.films[0].zones = {{"strip", geometry::ChartBox{0.5 - half / kSide, 0.5 + half / kSide, 0.0, 1.0}}};
  spec.films[0].rest_thickness = ScalarField::constant(1e-3);
  spec.films[0].edge = edge;
  spec.injections = {{"strip", volume * width, volume * width / 0.1, 0.0, std::nullopt}};
  spec.fat_viscosity = 1e-3;
  spec.step = 0.02;
  spec.max_step = 5.0;
  spec.end = 5000.0;
  spec.settle_skin_speed = 1e-9 * kThickness;
  auto simulation = make_simulation(make_plate(n), spec);
  if (!simulation) return {};
  run(*simulation);
  const simulation::StepReport& report = simulation->report();
  EXPECT_LT(report.gap_volume_relative_error, 1e-4);
  return {report.mean_pressure, report.skin_max_displacement};
}

Case edge_case() {
  return Case(
      {"coupled/10-zone-edge", "The edge of a zone under a thin plate",
       "Rigid: a clamped strip, p = 720 D V/L^5, wherever the edge lies on the grid. Attached: the beam equation "
       "D w'''' - (k t^2/4 w')' + k w = p with k(x) growing along the edge, by finite differences; p ends at the "
       "outline, or with the attachment where fat feathers."});
}

TEST(ZoneEdge, ARigidEdgeBetweenGridLinesIsAsGoodAsOneOnThem) {
  Case edge = edge_case();
  const int n = 64;
  double worst = 0.0;
  double worst_step = 0.0;
  double last = 0.0;
  for (int k = 0; k <= 10; ++k) {
    const double half = 0.25 * kSide + 0.1 * k * kSide / n;
    const double volume = kLift * 2 * half * 8.0 / 15.0;
    const double expected = 720 * kD * volume / std::pow(2 * half, 5);
    const double ratio = inflate(n, half, volume, {}).pressure / expected;
    worst = std::max(worst, std::abs(ratio - 1.0));
    if (k > 0) worst_step = std::max(worst_step, std::abs(ratio - last));
    last = ratio;
  }
  edge.record(
      {"largest error of p over ten places between two lines, 64 elements", "1", 0.1, worst, 0.0, Bound::kAtMost});
  edge.record({"largest change of that for a tenth of an element", "1", 0.03, worst_step, 0.0, Bound::kAtMost});
}

/// Half of a symmetric strip under the pressure 1, w = w' = 0 at its end. Fat that feathers presses
/// on all of it, other fat on the zone alone.
struct Beam {
  double volume = 0.0;  ///< of the fat, a metre of width and a pascal [m2/Pa]
  double lift = 0.0;    ///< [m/Pa]

  Beam(double half, const plan::AttachmentSpec& attachment) {
    const int n = 4000;
    const double end = half + attachment.width;
    const double reach = attachment.feathers ? end : half;
    const double dx = end / n;
    const auto k = [&](double x) { return x <= half ? 0.0 : attachment.stiffness * (x - half) / attachment.width; };
    // Unknowns are w at i dx, i = 0 .. n - 1; ghosts mirror at 0, and w_n = 0, w_{n+1} = w_{n-1}.
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int row, int i, double value) {
      i = std::abs(i);
      if (i == n) return;
      entries.emplace_back(row, i > n ? 2 * n - i : i, value);
    };
    Eigen::VectorXd load = Eigen::VectorXd::Zero(n);
    for (int i = 0; i < n; ++i) {
      const double bend = kD / std::pow(dx, 4);
      for (const auto& [offset, weight] : {std::pair{-2, 1.0}, {-1, -4.0}, {0, 6.0}, {1, -4.0}, {2, 1.0}}) {
        add(i, i + offset, weight * bend);
      }
      const double turn = kThickness * kThickness / 4 / (dx * dx);
      const double before = turn * k((i - 0.5) * dx);
      const double after = turn * k((i + 0.5) * dx);
      add(i, i, before + after + k(i * dx));
      add(i, i - 1, -before);
      add(i, i + 1, -after);
      load[i] = i * dx < reach ? 1.0 : 0.0;
    }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> factor(matrix);
    const Eigen::VectorXd w = factor.solve(load);
    lift = w[0];
    for (int i = 0; i < n && i * dx < reach; ++i) volume += 2 * dx * w[i] * (i == 0 ? 0.5 : 1.0);
  }
};

/// Inflates a strip with an attachment on finer and finer grids and holds it against the beam.
Beam compare_with_beam(Case& edge, const char* name, double half, const plan::AttachmentSpec& attachment) {
  plan::ZoneEdgeSpec attached;
  attached.attachment = attachment;
  const Beam beam(half, attachment);
  const double pressure = kLift / beam.lift;
  const std::vector<double> sizes = {32, 64, 128};
  std::vector<double> errors;
  AtRest fine;
  for (const double n : sizes) {
    fine = inflate(static_cast<int>(n), half, pressure * beam.volume, attached);
    errors.push_back(fine.pressure / pressure - 1.0);
  }
  edge.record({absl::StrCat("p over the beam's, ", name, ", 128 elements"), "1", 1.0, fine.pressure / pressure, 0.01});
  edge.record({absl::StrCat("lift over the beam's, ", name, ", 128 elements"), "1", 1.0, fine.lift / kLift, 0.01});
  edge.record_series({absl::StrCat("p with ", name), "elements along the strip", sizes, errors, 2.0, 1.5});
  return beam;
}

TEST(ZoneEdge, AnAttachmentGivesAsTheBeamOnItsFoundationDoes) {
  Case edge = edge_case();
  const double half = 0.26 * kSide;
  const Beam beam = compare_with_beam(edge, "an attachment", half, {5e5, 6e-3});
  const Beam clamped(half, {1e12, 6e-3});
  edge.record({"lift of the same pressure over that with a rigid edge", "1", 1.2, beam.lift / clamped.lift, 0.0,
               Bound::kAtLeast});
}

TEST(ZoneEdge, FatThatFeathersPressesOnTheAttachmentToo) {
  Case edge = edge_case();
  const double half = 0.26 * kSide;
  const Beam feathered = compare_with_beam(edge, "fat that feathers", half, {5e5, 6e-3, true});
  const Beam sealed(half, {5e5, 6e-3});
  edge.record({"volume of the same pressure over that of fat that ends at the outline", "1", 1.05,
               feathered.volume / sealed.volume, 0.0, Bound::kAtLeast});
}

}  // namespace
}  // namespace lipofill::verification
