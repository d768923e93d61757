#include "core/solid/tissue_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/base/field_violations.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

using ::testing::HasSubstr;

struct Input {
  HexMesh mesh = Box{{2, 2, 2}, {1, 1, 1}}.make();
  std::vector<ElasticMaterial> materials = {{1e5, 0.45, 1000.0}};
  NodeSupports supports;
  RayleighDamping damping;
  std::vector<WallSpring> springs = {{{0, 1, 2, 3}, {4, 5, 6, 7}, {0.25, 0.25, 0.25, 0.25}, 10.0}};
};

struct Case {
  const char* name;
  std::function<void(Input&)> spoil;
  const char* field;
  const char* description;
};

const double kNan = std::numeric_limits<double>::quiet_NaN();

class TissueChecksTest : public ::testing::TestWithParam<Case> {};

TEST_P(TissueChecksTest, NamesWhatIsWrong) {
  Input input;
  GetParam().spoil(input);
  const auto tissue = Tissue::create(input.mesh, input.materials, input.supports, input.damping, input.springs);
  ASSERT_EQ(tissue.status().code(), absl::StatusCode::kInvalidArgument);
  const std::vector<FieldViolation> violations = field_violations_of(tissue.status());
  ASSERT_FALSE(violations.empty());
  EXPECT_LE(violations.size(), 10u);
  EXPECT_EQ(violations[0].field, GetParam().field);
  EXPECT_THAT(violations[0].description, HasSubstr(GetParam().description));
}

INSTANTIATE_TEST_SUITE_P(
    Cases, TissueChecksTest,
    ::testing::Values(
        Case{"modulus", [](Input& in) { in.materials[0].youngs_modulus = -2.0; }, "materials[0].youngs_modulus",
             "-2 Pa"},
        Case{"incompressible", [](Input& in) { in.materials[0].poisson_ratio = 0.5; }, "materials[0].poisson_ratio",
             "[0, 0.5)"},
        Case{"density", [](Input& in) { in.materials[0].density = kNan; }, "materials[0].density", "nan"},
        Case{"prestress", [](Input& in) { in.materials[0].prestress = -1.0; }, "materials[0].prestress", "-1 Pa"},
        Case{"wall_spring_node", [](Input& in) { in.springs[0].outer[3] = 27; }, "springs[0]", "[0, 27)"},
        Case{"wall_spring_negative_node", [](Input& in) { in.springs[0].inner[1] = -1; }, "springs[0]", "[0, 27)"},
        Case{"wall_spring_weights", [](Input& in) { in.springs[0].weight[0] = 0.5; }, "springs[0]", "1.25"},
        Case{"wall_spring_weight_nan", [](Input& in) { in.springs[0].weight[2] = kNan; }, "springs[0]", "nan"},
        Case{"wall_spring_stiffness", [](Input& in) { in.springs[0].stiffness = 0.0; }, "springs[0]", "0 N/m"},
        Case{"wall_spring_infinite",
             [](Input& in) { in.springs[0].stiffness = std::numeric_limits<double>::infinity(); }, "springs[0]",
             "inf N/m"},
        Case{"wall_spring_slack", [](Input& in) { in.springs[0].slack = -1e-3; }, "springs[0]", "-0.001 m"},
        Case{"many_wall_springs",
             [](Input& in) {
               in.springs.assign(100, in.springs[0]);
               for (WallSpring& spring : in.springs) spring.slack = kNan;
             },
             "springs[0]", "nan m"},
        Case{"alpha", [](Input& in) { in.damping.alpha = -1.0; }, "damping.alpha", "-1 1/s"},
        Case{"beta", [](Input& in) { in.damping.beta = kNan; }, "damping.beta", "nan"},
        Case{"spring", [](Input& in) { in.supports.spring.assign(27, -3.0); }, "supports.spring[0]", "-3 N/m"},
        Case{"spring_count", [](Input& in) { in.supports.spring.assign(26, 0.0); }, "supports.spring", "must have 27"},
        Case{"fixed_count", [](Input& in) { in.supports.fixed.resize(28); }, "supports.fixed", "must have 27"},
        Case{"material_count", [](Input& in) { in.mesh.material.pop_back(); }, "mesh.material", "must have 8"},
        Case{"stacked_count", [](Input& in) { in.mesh.stacked.clear(); }, "mesh.stacked", "must have 8"},
        Case{"no_such_material", [](Input& in) { in.mesh.material[3] = 1; }, "mesh.hexahedra[3]", "material 1"},
        Case{"no_such_node", [](Input& in) { in.mesh.hexahedra[5][2] = 27; }, "mesh.hexahedra[5]", "node 27"},
        Case{"negative_node", [](Input& in) { in.mesh.hexahedra[5][2] = -1; }, "mesh.hexahedra[5]", "node -1"},
        Case{"not_finite", [](Input& in) { in.mesh.rest_positions(1, 4) = kNan; }, "mesh.rest_positions[4]", "finite"},
        Case{"loose_node",
             [](Input& in) {
               in.mesh.hexahedra.pop_back();
               in.mesh.material.pop_back();
               in.mesh.stacked.pop_back();
             },
             "mesh.rest_positions[26]", "no hexahedron"},
        Case{"mirrored", [](Input& in) { in.mesh.rest_positions.row(0) *= -1.0; }, "mesh.hexahedra[0]", "Jacobian"},
        Case{"collapsed", [](Input& in) { in.mesh.hexahedra[6][1] = in.mesh.hexahedra[6][0]; }, "mesh.hexahedra[6]",
             "Jacobian"},
        Case{"flat", [](Input& in) { in.mesh.rest_positions.row(2).setZero(); }, "mesh.hexahedra[0]",
             "greater than 0"}),
    [](const auto& kind) { return kind.param.name; });

}  // namespace
}  // namespace lipofill::solid::testing
