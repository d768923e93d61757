#include "client/cpp/io/mesh_files.h"

#include <gmock/gmock.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "temporary_folder.h"
#include "test_meshes.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

using MeshFilesTest = TemporaryFolderTest;

TEST_F(MeshFilesTest, SurfaceReadsBackMovedWithItsFields) {
  const std::vector<Array> mesh = square_mesh("film/deep");
  const std::vector<Array> fields = {
      float_field("film/deep.displacement", "mm", ArrayLocation::kPoint, 4, 3, {0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4}),
      float_field("film/deep.pressure", "Pa", ArrayLocation::kCell, 2, 1, {10, 20}),
      float_field("film/deep.velocity", "mm/s", ArrayLocation::kCell, 2, 3, {1, 2, 3, 4, 5, 6}),
      make_array<uint8_t>("film/deep.wet", "", ArrayLocation::kCell, ElementType::kUint8, {2}, {0, 1})};
  const auto views = mesh_views(mesh, fields);
  ASSERT_TRUE(views.ok()) << views.status();
  ASSERT_EQ(views->size(), 1u);
  EXPECT_STREQ(mesh_extension(views->front()), ".vtp");
  ASSERT_TRUE(write_mesh(folder_ / "film.vtp", views->front()).ok());

  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder_ / "film.vtp").c_str());
  reader->Update();
  vtkPolyData* surface = reader->GetOutput();
  ASSERT_EQ(surface->GetNumberOfPoints(), 4);
  ASSERT_EQ(surface->GetNumberOfCells(), 2);
  EXPECT_EQ(surface->GetPoint(2)[0], 1.0);
  EXPECT_EQ(surface->GetPoint(2)[2], 3.0);
  EXPECT_EQ(surface->GetCell(1)->GetPointId(1), 2);
  EXPECT_EQ(surface->GetPointData()->GetArray("displacement_mm")->GetComponent(3, 2), 4.0);
  EXPECT_EQ(surface->GetCellData()->GetArray("pressure_pa")->GetComponent(1, 0), 20.0);
  EXPECT_EQ(surface->GetCellData()->GetArray("velocity_mm_per_s")->GetComponent(0, 1), 2.0);
  EXPECT_EQ(surface->GetCellData()->GetArray("wet")->GetComponent(1, 0), 1.0);
}

TEST_F(MeshFilesTest, KeepsThePrecisionOfPointsFarFromTheOrigin) {
  std::vector<Array> mesh = square_mesh("scan");
  mesh[0] = make_array<double>("scan.points", "mm", ArrayLocation::kMesh, ElementType::kFloat64, {4, 3},
                               {5e8, 0, 0, 5e8 + 1, 0, 0, 5e8 + 1, 1, 0, 5e8, 1, 0});
  const std::vector<Array> fields = {
      float_field("scan.displacement", "mm", ArrayLocation::kPoint, 4, 3, {0.0625f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})};
  const auto views = mesh_views(mesh, fields);
  ASSERT_TRUE(views.ok()) << views.status();
  ASSERT_TRUE(write_mesh(folder_ / "scan.vtp", views->front()).ok());
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder_ / "scan.vtp").c_str());
  reader->Update();
  EXPECT_EQ(reader->GetOutput()->GetPoint(0)[0], 5e8 + 0.0625);
  EXPECT_EQ(reader->GetOutput()->GetPoint(2)[0], 5e8 + 1.0);
}

TEST_F(MeshFilesTest, HexahedraReadBack) {
  const std::vector<Array> mesh = cube_mesh();
  const auto views = mesh_views(mesh, {});
  ASSERT_TRUE(views.ok()) << views.status();
  EXPECT_STREQ(mesh_extension(views->front()), ".vtu");
  ASSERT_TRUE(write_mesh(folder_ / "tissue.vtu", views->front()).ok());
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder_ / "tissue.vtu").c_str());
  reader->Update();
  ASSERT_EQ(reader->GetOutput()->GetNumberOfCells(), 1);
  EXPECT_EQ(reader->GetOutput()->GetCellType(0), VTK_HEXAHEDRON);
  EXPECT_EQ(reader->GetOutput()->GetPoint(6)[2], 1.0);
}

TEST_F(MeshFilesTest, RefusesArraysThatDoNotFit) {
  std::vector<Array> mesh = square_mesh("skin");
  const auto refusal = [&mesh](const std::vector<Array>& fields) {
    return std::string(mesh_views(mesh, fields).status().message());
  };
  EXPECT_THAT(refusal({float_field("skin.pressure", "Pa", ArrayLocation::kPoint, 3, 1, {1, 2, 3})}),
              HasSubstr("another length"));
  EXPECT_THAT(refusal({float_field("scan.pressure", "Pa", ArrayLocation::kPoint, 4, 1, {1, 2, 3, 4})}),
              HasSubstr("no mesh"));
  EXPECT_THAT(refusal({float_field("skin.displacement", "mm", ArrayLocation::kPoint, 4, 1, {1, 2, 3, 4})}),
              HasSubstr("not (n, 3)"));
  const uint32_t outside = 4;
  std::memcpy(mesh[1].bytes.data(), &outside, sizeof outside);
  EXPECT_THAT(refusal({}), HasSubstr("index outside"));
  mesh.pop_back();
  EXPECT_THAT(refusal({}), HasSubstr("lacks"));
}

TEST_F(MeshFilesTest, SaysWhereItCannotWrite) {
  const std::vector<Array> mesh = square_mesh("skin");
  const auto views = mesh_views(mesh, {});
  const absl::Status status = write_mesh(folder_ / "no" / "skin.vtp", views->front());
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("skin.vtp"));
}

}  // namespace
}  // namespace lipofill::client
