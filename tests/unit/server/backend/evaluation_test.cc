#include "server/backend/evaluation.h"

#include <gmock/gmock.h>

#include <vector>

namespace lipofill::server {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::FloatNear;
using ::testing::HasSubstr;

template <typename T>
void add_array(const std::string& name, const std::vector<T>& values,
               google::protobuf::RepeatedPtrField<v1::ArraySlice>& arrays) {
  v1::ArraySlice& array = *arrays.Add();
  array.set_name(name);
  array.set_data(values.data(), values.size() * sizeof(T));
}

/// A square of 10 mm with one vertex a corner.
model::FaceModel make_square() {
  model::FaceModel model;
  model.is_square = true;
  return model;
}

v1::MeshSlice make_skin() {
  v1::MeshSlice meshes;
  add_array<float>("skin.points", {0, 0, 0, 10, 0, 0, 10, 10, 0, 0, 10, 0}, *meshes.mutable_arrays());
  add_array<uint32_t>("skin.cells", {0, 1, 2, 3}, *meshes.mutable_arrays());
  return meshes;
}

v1::FrameSlice raised(const std::string& mesh, int n, float height) {
  std::vector<float> displacement;
  for (int k = 0; k < n; ++k) displacement.insert(displacement.end(), {0.0F, 0.0F, height});
  v1::FrameSlice frame;
  add_array(mesh + ".displacement", displacement, *frame.mutable_fields());
  return frame;
}

/// Two triangles; vertices 1, 2 and 3 ride on the model, vertex 0 does not.
model::FaceModel make_scanned() {
  model::FaceModel model;
  geometry::SurfaceMesh& scan = model.geometry.scan;
  scan.points.resize(3, 4);
  scan.points << 0.0, 0.01, 0.01, 0.02,  //
      0.0, 0.0, 0.01, 0.01,              //
      0.0, 0.0, 0.0, 0.0;
  scan.triangles = {{0, 1, 2}, {1, 3, 2}};
  for (const int vertex : {1, 2, 3}) model.geometry.riders.push_back({vertex, {0.5, 0.5}});
  return model;
}

TEST(SkinPatch, OfASquareIsItsWholeSkinInMetres) {
  const auto patch = make_skin_patch(make_square(), make_skin(), raised("skin", 4, 2.0F));
  ASSERT_TRUE(patch.ok()) << patch.status();
  EXPECT_EQ(patch->mesh, "skin");
  EXPECT_THAT(patch->vertices, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(patch->before.triangles, ElementsAre(std::array{0, 1, 2}, std::array{0, 2, 3}));
  EXPECT_EQ(patch->after.triangles, patch->before.triangles);
  EXPECT_TRUE(patch->before.points.col(2).isApprox(Eigen::Vector3d(0.01, 0.01, 0.0)));
  EXPECT_TRUE(patch->after.points.col(2).isApprox(Eigen::Vector3d(0.01, 0.01, 0.002)));
}

TEST(SkinPatch, OfAScanIsWhatRidesOnTheModel) {
  const auto patch = make_skin_patch(make_scanned(), {}, raised("scan", 4, 1.0F));
  ASSERT_TRUE(patch.ok()) << patch.status();
  EXPECT_EQ(patch->mesh, "scan");
  EXPECT_THAT(patch->vertices, ElementsAre(1, 2, 3));
  EXPECT_THAT(patch->before.triangles, ElementsAre(std::array{0, 2, 1}));
  EXPECT_TRUE(patch->after.points.col(0).isApprox(Eigen::Vector3d(0.01, 0.0, 0.001)));
}

TEST(SkinPatch, OfArraysThatDoNotFitTheModelIsDataLoss) {
  const auto missing = make_skin_patch(make_square(), make_skin(), {});
  EXPECT_EQ(missing.status().code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(missing.status().message()), HasSubstr("skin.displacement"));
  EXPECT_EQ(make_skin_patch(make_square(), {}, raised("skin", 4, 1.0F)).status().code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(make_skin_patch(make_square(), make_skin(), raised("skin", 3, 1.0F)).status().code(),
            absl::StatusCode::kDataLoss);
  EXPECT_EQ(make_skin_patch(make_scanned(), {}, raised("scan", 5, 1.0F)).status().code(), absl::StatusCode::kDataLoss);
}

/// The skin raised by 2 mm.
SkinPatch make_raised_square() {
  return *make_skin_patch(make_square(), make_skin(), raised("skin", 4, 2.0F));
}

/// A plane around the square, at a height [m].
geometry::SurfaceMesh make_target(double height) {
  geometry::SurfaceMesh target;
  target.points.resize(3, 4);
  target.points << -0.1, 0.1, 0.1, -0.1,  //
      -0.1, -0.1, 0.1, 0.1,               //
      height, height, height, height;
  target.triangles = {{0, 1, 2}, {0, 2, 3}};
  return target;
}

TEST(Evaluation, SaysHowFarTheSkinIsFromTheTargetBeforeAndAfter) {
  const auto evaluation = evaluate(make_raised_square(), make_target(1.5e-3), nullptr);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status();
  EXPECT_NEAR(evaluation->simulated_to_target().max_mm(), 0.5, 1e-6);
  EXPECT_NEAR(evaluation->before_to_target().max_mm(), 1.5, 1e-6);
  EXPECT_GE(evaluation->hausdorff_mm(), evaluation->simulated_to_target().max_mm());
  EXPECT_THAT(evaluation->distance_mm(), Each(FloatNear(0.5F, 1e-5F)));
  EXPECT_THAT(evaluation->vertices(), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(evaluation->mesh(), "skin");
}

TEST(Evaluation, RefusesWhatCannotBeCompared) {
  EXPECT_EQ(evaluate(SkinPatch(), make_target(0.0), nullptr).status().code(), absl::StatusCode::kFailedPrecondition);
  SkinPatch large = make_raised_square();
  large.vertices.resize(400'001);
  EXPECT_EQ(evaluate(large, make_target(0.0), nullptr).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(evaluate(make_raised_square(), make_target(0.0), [] { return true; }).status().code(),
            absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace lipofill::server
