// Scenes: what is written is parsed again, and lies where the skin lies.

#include <gmock/gmock.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>

#include <Eigen/Geometry>
#include <cstring>

#include "client/cpp/io/mesh_files.h"
#include "client/cpp/json_file.h"
#include "client/cpp/scene/glb_scene.h"
#include "client/cpp/scene/slicer_scene.h"
#include "temporary_folder.h"

namespace lipofill::client {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

/// A quadrilateral of which one corner rises, 3 mm in the end, far from the origin.
class SceneTest : public TemporaryFolderTest {
 protected:
  static constexpr int kStills = 5;
  static constexpr double kFar = 4'000'000.0;

  void SetUp() override {
    TemporaryFolderTest::SetUp();
    std::vector<std::pair<double, std::string>> files;
    for (int k = 0; k < kStills; ++k) {
      const std::string name = "scan_000" + std::to_string(k) + ".vtp";
      write_still(folder_ / name, 3.0 * k / (kStills - 1));
      files.emplace_back(2.0 * k, name);
    }
    ASSERT_TRUE(write_collection(folder_ / "scan.pvd", files).ok());
  }

  static void write_still(const std::filesystem::path& file, double lift) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkFloatArray> displacement, pressure, thickness;
    displacement->SetName("displacement_mm");
    displacement->SetNumberOfComponents(3);
    pressure->SetName("pressure_pa");
    thickness->SetName("thickness_mm");
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {10.0, 0.0}, {10.0, 20.0}, {0.0, 20.0}}) {
      const double up = x > 0 && y > 0 ? lift : 0.0;
      points->InsertNextPoint(kFar + x, y, 30 + up);
      displacement->InsertNextTuple3(0, 0, up);
      pressure->InsertNextValue(static_cast<float>(1000 * up));
      thickness->InsertNextValue(static_cast<float>(up));
    }
    vtkNew<vtkCellArray> cells;
    cells->InsertNextCell({0, 1, 2, 3});
    vtkNew<vtkPolyData> surface;
    surface->SetPoints(points);
    surface->SetPolys(cells);
    for (vtkFloatArray* array : {displacement.Get(), pressure.Get(), thickness.Get()})
      surface->GetPointData()->AddArray(array);
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetFileName(file.c_str());
    writer->SetInputData(surface);
    ASSERT_EQ(writer->Write(), 1);
  }

  SkinMotion motion(size_t most = 100) const {
    auto read = read_skin_motion(folder_, most);
    EXPECT_TRUE(read.ok()) << read.status();
    return *std::move(read);
  }
};

/// A GLB taken apart again.
struct Glb {
  explicit Glb(const std::string& file) {
    uint32_t head[5];
    std::memcpy(head, file.data(), sizeof head);
    EXPECT_EQ(file.substr(0, 4), "glTF");
    EXPECT_EQ(head[1], 2U);
    EXPECT_EQ(head[2], file.size());
    json = nlohmann::json::parse(file.substr(20, head[3]));
    binary = file.substr(20 + head[3] + 8);
    EXPECT_EQ(json["buffers"][0]["byteLength"], binary.size());
  }
  template <typename Value>
  std::vector<Value> values(int accessor, int components) const {
    const auto& view = json["bufferViews"][json["accessors"][accessor]["bufferView"].get<size_t>()];
    std::vector<Value> found(json["accessors"][accessor]["count"].get<size_t>() * static_cast<size_t>(components));
    EXPECT_EQ(view["byteLength"], found.size() * sizeof(Value));
    std::memcpy(found.data(), binary.data() + view["byteOffset"].get<size_t>(), found.size() * sizeof(Value));
    return found;
  }
  nlohmann::json json;
  std::string binary;
};

TEST_F(SceneTest, TheMotionIsThatOfTheFolder) {
  const SkinMotion all = motion();
  ASSERT_EQ(all.stills.size(), 5U);
  EXPECT_EQ(all.triangles.size(), 2U);
  EXPECT_EQ(all.stills[2].time_s, 4.0);
  EXPECT_NEAR((all.rest_mm.col(2) - Vector3d(kFar + 10, 20, 30)).norm(), 0.0, 1e-6);
  EXPECT_EQ(all.pressure_pa[2], 3000.0);
  const SkinMotion few = motion(3);
  ASSERT_EQ(few.stills.size(), 3U);
  EXPECT_EQ(few.stills[1].time_s, 4.0);
  EXPECT_EQ(motion(1).stills[0].time_s, 8.0);
}

TEST_F(SceneTest, AGlbLiesWhereTheSkinLiesInMetresWithYUp) {
  const Glb glb(glb_of(motion(), {.name = "cheek"}));
  const auto& node = glb.json["nodes"][0];
  const auto& primitive = glb.json["meshes"][0]["primitives"][0];
  const auto rest = glb.values<float>(primitive["attributes"]["POSITION"], 3);
  const auto last = glb.values<float>(primitive["targets"][4]["POSITION"], 3);
  const auto q = node["rotation"].get<std::vector<double>>();
  const auto t = node["translation"].get<std::vector<double>>();
  const Eigen::Quaterniond turn(q[3], q[0], q[1], q[2]);
  const Vector3d local(rest[6] + last[6], rest[7] + last[7], rest[8] + last[8]);
  const Vector3d world = turn * (local * node["scale"][0].get<double>()) + Vector3d(t[0], t[1], t[2]);
  // In LPS z is up and y to the back: glTF has y up and z to the front.
  EXPECT_NEAR((world - Vector3d(kFar + 10, 33, -20) * 1e-3).norm(), 0.0, 1e-6);
  EXPECT_EQ(glb.json["accessors"][primitive["attributes"]["POSITION"].get<size_t>()]["max"][1], 10.0);
}

TEST_F(SceneTest, AGlbPlaysTheMotionAndShowsTheResult) {
  const Glb glb(glb_of(motion(), {.play_s = 4.0}));
  const auto& sampler = glb.json["animations"][0]["samplers"][0];
  EXPECT_THAT(glb.values<float>(sampler["input"], 1), ::testing::ElementsAre(0, 1, 2, 3, 4));
  const auto weights = glb.values<float>(sampler["output"], 1);
  for (size_t k = 0; k < 25; ++k) EXPECT_EQ(weights[k], k % 6 == 0 ? 1.0F : 0.0F);
  EXPECT_EQ(glb.json["meshes"][0]["weights"], nlohmann::json({0, 0, 0, 0, 1}));
  EXPECT_FALSE(Glb(glb_of(motion(1), {})).json.contains("animations"));
}

TEST_F(SceneTest, AGlbHasColoursWhereTheSkinMovedOrPresses) {
  for (const bool by_pressure : {false, true}) {
    const Glb glb(glb_of(motion(), {.by_pressure = by_pressure}));
    const auto colours = glb.values<uint16_t>(glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"], 4);
    EXPECT_EQ(colours[0], colours[4]);
    EXPECT_GT(colours[1], colours[9] + 10000);
    EXPECT_EQ(colours[3], 65535);
  }
}

TEST_F(SceneTest, ASceneOfSlicerSaysThatItIsInLps) {
  Landmarks landmarks;
  landmarks.points_mm["gonion_left"] = {1, 2, 3};
  ASSERT_TRUE(write_slicer_scene(folder_ / "my face.mrml", motion(), landmarks).ok());
  const std::string scene = *read_text_file(folder_ / "my face.mrml");
  EXPECT_THAT(scene, HasSubstr("fileName=\"my%20face_planned.vtp\" coordinateSystem=\"LPS\""));
  EXPECT_THAT(scene, HasSubstr("scalarRange=\"0 3\""));
  EXPECT_THAT(scene, HasSubstr("fileName=\"my%20face_landmarks.mrk.json\" coordinateSystem=\"LPS\""));
  EXPECT_THAT(*read_text_file(folder_ / "my face_landmarks.mrk.json"), HasSubstr("\"coordinateSystem\": \"LPS\""));
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder_ / "my face_planned.vtp").c_str());
  reader->Update();
  vtkPolyData* const planned = reader->GetOutput();
  EXPECT_EQ(vtkStringArray::SafeDownCast(planned->GetFieldData()->GetAbstractArray("SPACE"))->GetValue(0), "LPS");
  EXPECT_NEAR(planned->GetPointData()->GetArray("lift_mm")->GetComponent(2, 0), 3.0, 1e-6);
  EXPECT_NEAR(planned->GetPoint(2)[2], 33.0, 1e-6);
  EXPECT_EQ(planned->GetPointData()->GetArray("pressure_pa")->GetComponent(0, 0), 0.0);
}

TEST_F(SceneTest, AFolderWithoutASkinIsRefused) {
  std::filesystem::create_directories(folder_ / "none");
  EXPECT_THAT(std::string(read_skin_motion(folder_ / "none", 5).status().message()), HasSubstr("is not a folder"));
  write("scan_0002.vtp", "no surface");
  EXPECT_THAT(std::string(read_skin_motion(folder_, 100).status().message()), HasSubstr("scan_0002.vtp"));
  write("scan.pvd", "<DataSet timestep=\"soon\" part=\"0\" file=\"scan_0000.vtp\"/>");
  EXPECT_THAT(std::string(read_skin_motion(folder_, 100).status().message()), HasSubstr("soon"));
}

}  // namespace
}  // namespace lipofill::client
