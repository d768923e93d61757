// Sample plans found directly, against the same plans stepped until next to nothing is left to go.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <variant>

#include "client/cpp/volume/invesalius.h"
#include "client/cpp/volume/skin_extraction.h"
#include "tests/integration/faces/face_files.h"
#include "tests/verification/coupling/jaw_case.h"
#include "tests/verification/equilibrium/direct_case.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

/// The stepped plan has so far to go when it is compared [m].
constexpr double kLeft = 1e-6;

double largest(const Eigen::Matrix3Xd& difference) {
  return difference.colwise().norm().maxCoeff();
}

/// Compares the shape found directly with the one that steps come to.
void expect_what_steps_come_to(const std::string& name, const JawPlan& plan) {
  ASSERT_TRUE(plan.ok);
  const auto model = model::build_face_model(plan.model, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  DirectCase direct(*model, plan.simulation);
  const equilibrium::PoolTarget target = direct.target();
  const equilibrium::Settled settled = direct.solve();
  ASSERT_TRUE(settled.is_whole()) << settled.reason;
  const auto stepped = step_until_at_rest(*model, plan.simulation, kLeft);
  ASSERT_NE(stepped, nullptr);
  const double off = 1e3 * largest(direct.skin(settled) - skin_of(*stepped));
  const double lost = (settled.pool_volume - target.volume).cwiseAbs().maxCoeff() / target.volume.maxCoeff();

  Case settled_case({"coupled/8-settled-directly", "Settled shapes of sample plans, found directly",
                     "The same plans in time steps until the skin has 0.001 mm left to go."});
  settled_case.record({name + ": largest difference of the skin", "mm", 3e-3, off, 0.0, Bound::kAtMost});
  settled_case.record({name + ": volumes of pools, share off", "1", 1e-12, lost, 0.0, Bound::kAtMost});
  settled_case.record({name + ": factors", "1", 3.0, static_cast<double>(settled.cost.factors), 0.0, Bound::kAtMost});
  settled_case.record(
      {name + ": iterations", "1", 12.0, static_cast<double>(settled.cost.iterations), 0.0, Bound::kAtMost});
}

class SamplePlan : public ::testing::TestWithParam<std::string> {};

TEST_P(SamplePlan, FoundDirectlyIsTheOneThatStepsComeTo) {
  expect_what_steps_come_to(GetParam(), load_sample_plan(GetParam() + ".json"));
}

INSTANTIATE_TEST_SUITE_P(Every, SamplePlan, ::testing::Values("square", "jaw_angle", "two_planes", "elastography"),
                         [](const auto& info) { return info.param; });

/// The paper's plan on a scan of a person.
TEST(RealFace, FoundDirectlyIsTheOneThatStepsComeTo) {
  const std::filesystem::path shared = LIPOFILL_SHARED_DATA;
  if (!std::filesystem::exists(shared / "lps_patient_before.obj")) GTEST_SKIP() << "there is no patient in " << shared;
  JawPlan plan = load_sample_plan("jaw_angle.json");
  ASSERT_TRUE(plan.ok);
  auto& region = std::get<geometry::ScanRegionSpec>(plan.model.region);
  auto scan = geometry::read_surface(lipofill::testing::read_whole(shared / "lps_patient_before.obj"),
                                     geometry::SurfaceFormat::kObj, 1e-3);
  ASSERT_TRUE(scan.ok()) << scan.status();
  region.scan = *std::move(scan);
  const auto patient = nlohmann::json::parse(lipofill::testing::read_whole(shared / "lps_patient.json"));
  region.axes.reset();
  region.landmarks.clear();
  for (const auto& [name, at] : patient.at("landmarks_before").items()) {
    region.landmarks[name] = 1e-3 * lipofill::testing::to_vector(at);
  }
  expect_what_steps_come_to("jaw_angle on a real face", plan);
}

/// The cheek of the head CT that Debian's invesalius-examples has, as deploy/demo --ct extracts it.
TEST(CtCheek, FoundDirectlyIsTheOneThatStepsComeTo) {
  const std::filesystem::path head = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
  if (!std::filesystem::exists(head)) GTEST_SKIP() << "no head CT: install Debian's invesalius-examples";
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "ct_cheek";
  std::filesystem::create_directories(folder);
  const auto volume = client::convert_invesalius(head, folder / "head.mha");
  ASSERT_TRUE(volume.ok()) << volume.status();
  client::SkinExtraction extraction;
  extraction.smoothing_iterations = 15;
  extraction.target_triangles = 150000;
  const auto skin = client::extract_skin(folder / "head.mha", folder / "skin.ply", extraction);
  ASSERT_TRUE(skin.ok()) << skin.status();
  expect_what_steps_come_to("ct_cheek", load_sample_plan("ct_cheek.json", folder / "skin.ply"));
  std::filesystem::remove_all(folder);
}

/// Four times the fat of the plan, 18 mL below a skin of 4 mm: in parts where it does not go in at
/// once.
TEST(LargeLoad, ComesToItsShapeOrSaysHowFarItGoes) {
  JawPlan plan = load_jaw_plan();
  ASSERT_TRUE(plan.ok);
  for (plan::InjectionSpec& injection : plan.simulation.injections) injection.volume *= 4.0;
  const auto model = model::build_face_model(plan.model, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  DirectCase direct(*model, plan.simulation);
  const equilibrium::Settled settled = direct.solve();
  std::printf("share %g, %d factors, %d iterations, %zu closed: %s\n", settled.share, settled.cost.factors,
              settled.cost.iterations, settled.closed.size(), settled.reason.c_str());
  EXPECT_GT(settled.share, 0.5);
  EXPECT_EQ(settled.is_whole(), settled.reason.empty());
  EXPECT_LE(settled.force_error, 1e-3);
  EXPECT_LT((settled.pool_volume - settled.fat_volume).cwiseAbs().maxCoeff(), 1e-12 * settled.fat_volume.sum());
}

}  // namespace
}  // namespace lipofill::verification
