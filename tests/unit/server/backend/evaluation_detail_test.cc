#include "server/backend/evaluation_detail.h"

#include <gmock/gmock.h>

#include "core/base/field_violations.h"
#include "core/geometry/surface_topology.h"
#include "server/wire/rim_width.h"
#include "tests/unit/planning/test_heads.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;

/// A square skin of 40 mm with nodes every 10 mm, raised by 1 mm where x > 20 mm.
struct Case {
  model::FaceModel model;
  SkinPatch patch;
  v1::SimulationSpec spec;
  v1::FrameSlice frame;
  geometry::SurfaceMesh target;  ///< 1 mm above the skin at rest
};

geometry::SurfaceMesh make_grid(int n, double spacing, double height) {
  geometry::SurfaceMesh grid;
  grid.points.resize(3, (n + 1) * (n + 1));
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const int a = j * (n + 1) + i;
      grid.points.col(a) << spacing * i, spacing * j, height;
      if (i == n || j == n) continue;
      grid.triangles.push_back({a, a + 1, a + n + 2});
      grid.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  }
  return grid;
}

Case make_case() {
  Case c;
  c.model.is_square = true;
  c.patch.mesh = "skin";
  c.patch.before = make_grid(4, 0.01, 0.0);
  c.patch.after = c.patch.before;
  std::vector<float> zones;
  for (int v = 0; v < c.patch.before.n_vertices(); ++v) {
    c.patch.vertices.push_back(static_cast<uint32_t>(v));
    const double x = c.patch.before.points(0, v);
    if (x > 0.0199) c.patch.after.points(2, v) = 0.001;
    zones.push_back(x > 0.0199 ? 2.0F : (x < 0.0101 ? 1.0F : 0.0F));
  }
  v1::ArraySlice& field = *c.frame.add_fields();
  field.set_name("skin.zone");
  field.set_data(zones.data(), zones.size() * sizeof(float));
  v1::Film& film = *c.spec.add_films();
  film.add_zones()->set_name("left");
  film.add_zones()->set_name("right");
  c.target = make_grid(12, 0.01, 0.001);
  c.target.points.topRows(2).array() -= 0.04;
  return c;
}

TEST(EvaluationDetail, FindsTheZonesUnderTheSkin) {
  const Case c = make_case();
  const PatchZones zones = find_patch_zones(c.model, c.spec, c.patch, c.frame);
  EXPECT_THAT(zones.names, ElementsAre("left", "right"));
  EXPECT_EQ(zones.of_vertex[0], 0);
  EXPECT_EQ(zones.of_vertex[2], 1);
  EXPECT_TRUE(find_patch_zones(c.model, c.spec, c.patch, {}).names.empty());
}

TEST(EvaluationDetail, ComparesByZoneBothWays) {
  const Case c = make_case();
  v1::Evaluation evaluation;
  const PatchZones zones = find_patch_zones(c.model, c.spec, c.patch, c.frame);
  ASSERT_TRUE(add_details(c.model, c.patch, zones, c.target, 0.0, nullptr, evaluation).ok());
  ASSERT_EQ(evaluation.zones_size(), 2);
  EXPECT_EQ(evaluation.zones(0).zone(), "left");
  EXPECT_NEAR(evaluation.zones(0).simulated().skin_to_target().rms_mm(), 1.0, 1e-9) << "it was not raised";
  EXPECT_NEAR(evaluation.zones(1).before().skin_to_target().signed_mean_mm(), -1.0, 1e-9);
  EXPECT_NEAR(evaluation.zones(1).simulated().skin_to_target().max_mm(), 0.0, 1e-9);
  EXPECT_NEAR(evaluation.zones(1).simulated().target_to_skin().max_mm(), 0.0, 1e-9);
  EXPECT_NEAR(evaluation.zones(1).before().volume().deficit_ml(), 0.8, 1e-9) << "20 x 40 x 1 mm3";
  EXPECT_NEAR(evaluation.without_rim_before().hausdorff_mm(), 1.0, 1e-9);
  EXPECT_FALSE(evaluation.has_symmetry()) << "a square has no face";
}

// The target ends 10 mm beyond the skin's edge at x = 0; a rim of 15 mm takes what faces its
// border.
TEST(EvaluationDetail, LeavesOutWhatIsNearTheTargetsRim) {
  Case c = make_case();
  c.target = make_grid(6, 0.01, 0.001);
  c.target.points.topRows(2).array() -= 0.01;
  const PatchZones zones = find_patch_zones(c.model, c.spec, c.patch, c.frame);
  v1::Evaluation whole, inner;
  ASSERT_TRUE(add_details(c.model, c.patch, zones, c.target, 0.0, nullptr, whole).ok());
  ASSERT_TRUE(add_details(c.model, c.patch, zones, c.target, 0.015, nullptr, inner).ok());
  EXPECT_EQ(whole.without_rim().skin_vertices(), 25u);
  EXPECT_EQ(inner.without_rim().skin_vertices(), 9u) << "the outermost vertices are 10 mm from the border";
}

// A head whose left cheek has lost 8 mm, simulated as the even head that is its target too.
TEST(EvaluationDetail, HasTheSymmetryOfTheFaceAndOfItsTarget) {
  Case c;
  std::vector<planning::Bump> bumps = planning::symmetric_bumps();
  bumps.push_back({{0.75, -0.4, 0.45}, 0.35, -0.008});
  c.model.geometry.scan = planning::make_head(bumps);
  c.target = planning::make_even_head();
  c.model.geometry.landmarks = planning::make_landmarks(c.target);
  std::vector<int> cheek;
  const Eigen::Vector3d towards = bumps.back().direction.normalized();
  for (size_t t = 0; t < c.target.triangles.size(); ++t) {
    const Eigen::Vector3d corner = c.target.points.col(c.target.triangles[t][0]);
    if (corner.normalized().dot(towards) > std::cos(0.4)) cheek.push_back(static_cast<int>(t));
  }
  const geometry::SubSurface part = geometry::extract_triangles(c.model.geometry.scan, cheek);
  c.patch.mesh = "scan";
  c.patch.before = part.mesh;
  c.patch.after = geometry::extract_triangles(c.target, cheek).mesh;
  for (const int v : part.whole_of_vertex) c.patch.vertices.push_back(static_cast<uint32_t>(v));
  v1::Evaluation evaluation;
  ASSERT_TRUE(add_details(c.model, c.patch, {}, c.target, 0.0, nullptr, evaluation).ok());
  ASSERT_TRUE(evaluation.has_symmetry());
  EXPECT_GT(evaluation.symmetry().before_mm(), 2.0);
  EXPECT_LT(evaluation.symmetry().simulated_mm(), 0.2) << "the skin is where the even head has it";
  ASSERT_TRUE(evaluation.symmetry().has_target_mm());
  EXPECT_NEAR(evaluation.symmetry().target_mm(), evaluation.symmetry().simulated_mm(), 0.05);
  c.target = c.model.geometry.scan;
  ASSERT_TRUE(add_details(c.model, c.patch, {}, c.target, 0.0, nullptr, evaluation).ok());
  EXPECT_NEAR(evaluation.symmetry().target_mm(), evaluation.symmetry().before_mm(), 1e-6) << "it is the face itself";
}

TEST(EvaluationDetail, RimIsWithinItsBounds) {
  v1::EvaluateSimulationRequest request;
  FieldViolations violations;
  EXPECT_DOUBLE_EQ(read_rim_width(request, violations), 0.005);
  EXPECT_TRUE(violations.empty());
  request.set_rim_mm(51.0);
  read_rim_width(request, violations);
  EXPECT_EQ(field_violations_of(violations.to_status()).at(0).field, "rim_mm");
}

}  // namespace
}  // namespace lipofill::server
