// A patient turned, moved or measured in other units is the same patient.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>

#include "core/simulation/simulation.h"
#include "tests/verification/coupling/jaw_case.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using Change = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// Displacement of the skin after 0.4 s of the plan on the scan and landmarks that `change` makes
/// [mm] (3, n).
Eigen::Matrix3Xd run_changed(const Change& change) {
  JawPlan plan = load_jaw_plan();
  if (!plan.ok) return {};
  auto& region = std::get<geometry::ScanRegionSpec>(plan.model.region);
  for (Eigen::Index k = 0; k < region.scan.points.cols(); ++k) {
    region.scan.points.col(k) = change(region.scan.points.col(k));
  }
  for (auto& [name, position] : region.landmarks) position = change(position);
  if (region.axes.has_value()) {
    const Eigen::Vector3d origin = change(Eigen::Vector3d::Zero());
    for (Eigen::Vector3d* axis : {&region.axes->left, &region.axes->up, &region.axes->forward}) {
      *axis = (change(*axis) - origin).normalized();
    }
  }
  plan.simulation.end = 0.4;
  auto model = model::build_face_model(plan.model, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  if (!model.ok()) return {};
  auto simulation = simulation::Simulation::create(*model, plan.simulation);
  EXPECT_TRUE(simulation.ok()) << simulation.status();
  if (!simulation.ok()) return {};
  while ((*simulation)->phase() == simulation::Phase::kRunning) (*simulation)->advance_step();
  EXPECT_EQ((*simulation)->phase(), simulation::Phase::kFinished) << (*simulation)->reason();
  for (const auto& field : (*simulation)->frame({"skin"})) {
    if (field.name != "displacement") continue;
    return Eigen::Map<const Eigen::Matrix3Xf>(field.values.data(), 3,
                                              static_cast<Eigen::Index>(field.values.size() / 3))
        .cast<double>();
  }
  return {};
}

TEST(RigidInvariance, ATurnedAndMovedPatientGivesTheSameResult) {
  Case record({"conservation/5-invariance", "The patient turned, moved, and in other units",
               "the same displacement in the patient's own frame"});
  const Eigen::Matrix3Xd here = run_changed([](const Eigen::Vector3d& x) { return x; });
  ASSERT_GT(here.cols(), 0);
  const double largest = here.colwise().norm().maxCoeff();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.8, 0.5).normalized()).toRotationMatrix();
  const Eigen::Matrix3Xd turned = run_changed([&](const Eigen::Vector3d& x) { return Eigen::Vector3d(turn * x); });
  ASSERT_EQ(turned.cols(), here.cols());
  record.record({"turned by 63 degrees: largest difference over the largest displacement", "1", 1e-5,
                 (turn.transpose() * turned - here).colwise().norm().maxCoeff() / largest, 0.0, Bound::kAtMost});
  const Eigen::Vector3d shift(0.31, -0.12, 0.22);
  const Eigen::Matrix3Xd moved = run_changed([&](const Eigen::Vector3d& x) { return Eigen::Vector3d(x + shift); });
  ASSERT_EQ(moved.cols(), here.cols());
  record.record({"moved by 0.4 m: largest difference over the largest displacement", "1", 1e-5,
                 (moved - here).colwise().norm().maxCoeff() / largest, 0.0, Bound::kAtMost});
  // A scan in inches and back: every coordinate rounds.
  const Eigen::Matrix3Xd inches =
      run_changed([](const Eigen::Vector3d& x) { return Eigen::Vector3d(((x / 0.0254) * 25.4) / 1000.0); });
  ASSERT_EQ(inches.cols(), here.cols());
  record.record({"through inches: largest difference over the largest displacement", "1", 1e-5,
                 (inches - here).colwise().norm().maxCoeff() / largest, 0.0, Bound::kAtMost});
}

}  // namespace
}  // namespace lipofill::verification
