#include "core/geometry/mesh_topology.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lipofill::geometry {
namespace {

using ::testing::ElementsAre;

/// Two hexahedra beside each other, one layer, 1 m wide, and a scan of one triangle.
FaceGeometry make_geometry() {
  FaceGeometry face;
  LayeredGrid& grid = face.grid;
  grid.n_xi = 2;
  grid.n_eta = 1;
  grid.elements_through = {1};
  grid.nodes.resize(3, 12);
  for (int level = 0; level < 2; ++level) {
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 3; ++i) grid.nodes.col(grid.node(level, i, j)) << i, j, -level;
    }
  }
  face.scan.points.resize(3, 3);
  face.scan.points << 0, 1, 0, 0, 0, 1, 0.25, 0.25, 0.25;
  face.scan.triangles = {{2, 0, 1}};
  return face;
}

TEST(MeshTopology, TheSkinIsTheOutermostLevel) {
  const MeshTopology skin = make_skin_mesh(make_geometry().grid);
  EXPECT_EQ(skin.name, "skin");
  EXPECT_EQ(skin.kind, 4);
  EXPECT_EQ(skin.n_points(), 6);
  EXPECT_THAT(skin.cells, ElementsAre(0, 1, 4, 3, 1, 2, 5, 4));
  EXPECT_EQ(skin.points_mm[3 * 5], 2000.0);
  EXPECT_EQ(skin.points_mm[3 * 5 + 1], 1000.0f);
}

TEST(MeshTopology, AHexahedronBeginsWithItsDeepFace) {
  const MeshTopology tissue = make_tissue_mesh(make_geometry().grid);
  EXPECT_EQ(tissue.kind, 8);
  EXPECT_EQ(tissue.n_cells(), 2);
  EXPECT_THAT(std::vector<uint32_t>(tissue.cells.begin(), tissue.cells.begin() + 8),
              ElementsAre(6, 7, 10, 9, 0, 1, 4, 3));
  EXPECT_EQ(tissue.points_mm[3 * 6 + 2], -1000.0f);
}

TEST(MeshTopology, AModelShowsWhatItHas) {
  FaceGeometry face = make_geometry();
  std::vector<MeshTopology> meshes = make_model_meshes(face);
  ASSERT_EQ(meshes.size(), 3u);
  EXPECT_EQ(meshes[1].name, "scan");
  EXPECT_EQ(meshes[1].kind, 3);
  EXPECT_THAT(meshes[1].cells, ElementsAre(2, 0, 1));
  EXPECT_EQ(meshes[1].points_mm[2], 250.0f);
  EXPECT_EQ(meshes[2].name, "tissue");
  face.scan = {};
  face.grid.elements_through.clear();
  meshes = make_model_meshes(face);
  ASSERT_EQ(meshes.size(), 1u);
  EXPECT_EQ(meshes[0].name, "skin");
}

}  // namespace
}  // namespace lipofill::geometry
