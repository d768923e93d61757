// A second opinion: CalculiX, with its own elements, finds the shape of the skin under the pressure
// of our settled films. The deck is the one that the service exports: mesh, supports and pressure
// are ours; elements, constitutive law and solver are theirs.

#include <Eigen/Geometry>
#include <cstdio>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/export/calculix_deck.h"
#include "tests/verification/coupling/calculix_run.h"
#include "tests/verification/coupling/jaw_case.h"
#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ScalarField;
using simulation::Simulation;

constexpr double kAgreement = 0.03;

Eigen::Matrix3Xd skin_displacement(const Simulation& simulation) {
  const auto fields = simulation.frame({"skin"});
  const Eigen::Map<const Eigen::Matrix3Xf> in_mm(fields[0].values.data(), 3,
                                                 static_cast<Eigen::Index>(fields[0].values.size() / 3));
  return 1e-3 * in_mm.cast<double>();
}

/// Largest angle between the skin's quadrilaterals before and after, in degrees.
double largest_rotation(const Simulation& simulation, const Eigen::Matrix3Xd& displacement) {
  const geometry::LayeredGrid& grid = simulation.model().geometry.grid;
  const Eigen::Matrix3Xd rest = grid.nodes.leftCols(grid.nodes_per_level());
  const Eigen::Matrix3Xd now = rest + displacement;
  double cosine = 1.0;
  for (int j = 0; j < grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) {
      const auto normal = [&](const Eigen::Matrix3Xd& x) {
        const Eigen::Vector3d a = x.col(grid.surface_index(i + 1, j + 1)) - x.col(grid.surface_index(i, j));
        const Eigen::Vector3d b = x.col(grid.surface_index(i, j + 1)) - x.col(grid.surface_index(i + 1, j));
        return a.cross(b).normalized().eval();
      };
      cosine = std::min(cosine, normal(rest).dot(normal(now)));
    }
  }
  return std::acos(cosine) * 180.0 / 3.14159265358979323846;
}

std::string deck_of(const Simulation& simulation) {
  auto deck = exporting::CalculixDeck::create(simulation);
  EXPECT_TRUE(deck.ok()) << deck.status();
  return deck.ok() ? deck->read(size_t{1} << 30) : "";
}

/// Displacement of the skin [m] as ccx finds it; empty, and a failure, where it finds none.
Eigen::Matrix3Xd ask_calculix(const std::string& deck) {
  const auto result = solve_with_calculix(deck);
  EXPECT_TRUE(result.ok()) << result.status();
  if (result.ok()) std::printf("ccx took %.1f s\n", result->seconds);
  return result.ok() ? result->skin : Eigen::Matrix3Xd();
}

double relative_difference(const Eigen::Matrix3Xd& ours, const Eigen::Matrix3Xd& theirs) {
  return (ours - theirs).norm() / theirs.norm();
}

double largest(const Eigen::Matrix3Xd& displacement) {
  return displacement.colwise().norm().maxCoeff();
}

/// Node by node over the skin, and at the peak.
void expect_agreement(const std::string& what, const Eigen::Matrix3Xd& ours, const Eigen::Matrix3Xd& theirs,
                      Case& record) {
  ASSERT_EQ(theirs.cols(), ours.cols());
  record.record({what + ", largest displacement", "mm", 1e3 * largest(theirs), 1e3 * largest(ours), kAgreement,
                 Bound::kRelative});
  record.record({what + ", difference over the skin, relative L2 norm", "1", kAgreement,
                 relative_difference(ours, theirs), 0.0, Bound::kAtMost});
}

Case second_opinion() {
  return Case({"coupled/8-calculix", "A second opinion: CalculiX under the same pressure",
               "ccx with C3D8I elements and NLGEOM on the exported deck: the same nodes, supports and film pressure, "
               "its own elements, law (linear between second Piola-Kirchhoff stress and Green-Lagrange strain; ours is "
               "linear in the corotated small strain) and solver"});
}

std::string title(const char* body, const Simulation& simulation, const Eigen::Matrix3Xd& ours) {
  return absl::StrFormat("%s turned by up to %.0f degrees", body, largest_rotation(simulation, ours));
}

/// 40 x 40 x 2 mm, clamped all round, over a film that holds `volume`.
std::unique_ptr<Simulation> inflate_plate(double volume) {
  model::FaceModelSpec model;
  model.region = geometry::SquareSpec{0.04, 0.04};
  model.n_xi = model.n_eta = 24;
  model.layers = {{"plate", {ScalarField::constant(2e-3), 1}, {2e5, 0.45, 1100.0}}};
  auto built = model::build_face_model(model, nullptr);
  EXPECT_TRUE(built.ok()) << built.status();
  plan::SimulationSpec spec;
  spec.films = {make_film(plan::FilmWallKind::kTissue, 12, 12)};
  spec.films[0].below_layer = "plate";
  spec.injections = {{"all", volume, volume, 0.0, std::nullopt}};
  spec.fat_viscosity = 1.0;
  spec.step = 0.02;
  spec.max_step = 5.0;
  spec.end = 500.0;
  spec.settle_skin_speed = 1e-7;
  auto simulation = make_simulation(*built, spec);
  run(*simulation);
  return simulation;
}

TEST(SecondOpinion, InflatedClampedPlate) {
  if (!has_calculix()) GTEST_SKIP() << "ccx is not installed (Debian package calculix-ccx)";
  Case record = second_opinion();
  for (const double volume : {0.3e-6, 1.2e-6}) {
    const auto simulation = inflate_plate(volume);
    const Eigen::Matrix3Xd ours = skin_displacement(*simulation);
    expect_agreement(title("plate", *simulation, ours), ours, ask_calculix(deck_of(*simulation)), record);
  }
}

/// The jaw patch at rest, both zones filled with a share of the plan's volumes.
class JawPatch : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_calculix()) GTEST_SKIP() << "ccx is not installed (Debian package calculix-ccx)";
    jaw_ = make_jaw_case();
    ASSERT_TRUE(jaw_.model);
  }
  std::unique_ptr<Simulation> inflate(double share) const {
    plan::SimulationSpec spec = jaw_.spec;
    for (plan::InjectionSpec& injection : spec.injections) injection.volume *= share;
    auto simulation = make_simulation(jaw_.model, spec);
    run(*simulation);
    return simulation;
  }
  JawCase jaw_;
};

/// Both sides have the same law here: what is left is elements and solver.
TEST_F(JawPatch, NeoHookeanTissueAgreesAtAnyRotation) {
  model::FaceModelSpec model = load_jaw_plan().model;
  for (model::TissueLayerSpec& layer : model.layers) layer.material.law = solid::TissueLaw::kNeoHookean;
  auto built = model::build_face_model(model, nullptr);
  ASSERT_TRUE(built.ok()) << built.status();
  jaw_.model = *std::move(built);
  Case record({"coupled/10-calculix-neo-hookean", "A second opinion on neo-Hookean tissue: CalculiX",
               "ccx with C3D8I elements and the same law (*HYPERELASTIC, NEO HOOKE) on the exported deck"});
  for (const double share : {0.2, 0.6}) {
    const auto simulation = inflate(share);
    const Eigen::Matrix3Xd ours = skin_displacement(*simulation);
    expect_agreement(title("jaw patch", *simulation, ours), ours, ask_calculix(deck_of(*simulation)), record);
  }
}

TEST_F(JawPatch, AgreesAtModerateRotation) {
  Case record = second_opinion();
  const auto simulation = inflate(0.2);
  const Eigen::Matrix3Xd ours = skin_displacement(*simulation);
  expect_agreement(title("jaw patch", *simulation, ours), ours, ask_calculix(deck_of(*simulation)), record);
}

// Where the skin stretches by several per cent the constitutive law decides, and none of ccx' is
// ours: linear elasticity in Green-Lagrange strain stiffens under tension (P = E (e + 1.5 e^2) for
// a bar), neo-Hooke softens (E (e - e^2)), the corotational law does neither (E e). Ours must lie
// between the two, and near their mean.
TEST_F(JawPatch, LiesBetweenTheLawsWhereTheSkinStretches) {
  Case record = second_opinion();
  const auto simulation = inflate(0.6);
  const Eigen::Matrix3Xd ours = skin_displacement(*simulation);
  const std::string what = title("jaw patch", *simulation, ours);
  const std::string deck = deck_of(*simulation);
  const Eigen::Matrix3Xd stiffening = ask_calculix(deck);
  const Eigen::Matrix3Xd softening = ask_calculix(with_neo_hookean_tissue(deck));
  ASSERT_EQ(stiffening.cols(), ours.cols());
  ASSERT_EQ(softening.cols(), ours.cols());
  EXPECT_LT(largest(stiffening), largest(ours));
  EXPECT_LT(largest(ours), largest(softening));
  expect_agreement(what + ", mean of two laws", ours, 0.5 * (stiffening + softening), record);
  for (const auto& [law, theirs] :
       {std::pair("linear in Green-Lagrange strain", &stiffening), std::pair("neo-Hookean", &softening)}) {
    record.record({absl::StrCat(what, ", ", law, ": largest displacement"), "mm", 1e3 * largest(*theirs),
                   1e3 * largest(ours), 0.0, Bound::kReported});
    record.record({absl::StrCat(what, ", ", law, ": difference over the skin, relative L2 norm"), "1", 0.0,
                   relative_difference(ours, *theirs), 0.0, Bound::kReported});
  }
}

}  // namespace
}  // namespace lipofill::verification
