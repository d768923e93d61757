#include "client/cpp/io/result_folder.h"

#include <gmock/gmock.h>

#include "client/cpp/json_file.h"
#include "temporary_folder.h"
#include "test_meshes.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

class ResultFolderTest : public TemporaryFolderTest {
 protected:
  static std::vector<Array> join(std::vector<Array> a, const std::vector<Array>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }
};

TEST_F(ResultFolderTest, NumbersFramesAndCollectsThem) {
  ResultFolder folder(folder_ / "out");
  ASSERT_TRUE(folder.prepare().ok());
  folder.set_meshes(join(join(square_mesh("skin"), square_mesh("film/deep")), cube_mesh()));
  ASSERT_TRUE(folder.write_frame(0.0, {}).ok());
  ASSERT_TRUE(folder.write_frame(0.5, {}).ok());
  ASSERT_TRUE(folder.write_frame(0.5, {}).ok());
  EXPECT_EQ(folder.frames(), 2);
  for (const char* name : {"skin_0000.vtp", "skin_0001.vtp", "film_0001.vtp", "tissue_0001.vtu"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / name)) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "skin_0002.vtp"));
  const std::string collection = *read_text_file(folder.path() / "skin.pvd");
  EXPECT_THAT(collection, HasSubstr("timestep=\"0.5\" group=\"\" part=\"0\" file=\"skin_0001.vtp\""));
  EXPECT_EQ(last_frame_file(folder.path(), "skin"), folder.path() / "skin_0001.vtp");
  EXPECT_EQ(last_frame_file(folder.path(), "scan"), std::filesystem::path());
}

TEST_F(ResultFolderTest, WritesThePreviewBesideTheSeries) {
  ResultFolder folder(folder_);
  ASSERT_TRUE(folder.prepare().ok());
  folder.set_meshes(join(join(square_mesh("skin"), square_mesh("film/deep")), cube_mesh()));
  ASSERT_TRUE(
      folder.write_preview({float_field("skin.pressure", "Pa", ArrayLocation::kPoint, 4, 1, {1, 2, 3, 4})}).ok());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "skin_preview.vtp"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "film_preview.vtp")) << "it has no fields there";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "skin.pvd"));
  EXPECT_EQ(folder.frames(), 0);
  EXPECT_EQ(last_frame_file(folder_, "skin"), std::filesystem::path());
  ASSERT_TRUE(folder.prepare().ok());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "skin_preview.vtp")) << "of an earlier run";
}

TEST_F(ResultFolderTest, SeveralFilmsGoByName) {
  ResultFolder folder(folder_);
  ASSERT_TRUE(folder.prepare().ok());
  folder.set_meshes(join(square_mesh("film/deep"), square_mesh("film/sub/dermal")));
  ASSERT_TRUE(folder.write_frame(0.0, {}).ok());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "film_deep_0000.vtp"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "film_sub_dermal_0000.vtp"));
}

TEST_F(ResultFolderTest, ClearsAnEarlierRunAndNothingElse) {
  for (const char* name :
       {"skin_0007.vtp", "film_deep_0000.vtp", "tissue.pvd", "skin_notes.txt", "summary.json", "my_skin_0001.vtp"}) {
    write(name, "x");
  }
  ASSERT_TRUE(ResultFolder(folder_).prepare().ok());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "skin_0007.vtp"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "film_deep_0000.vtp"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "tissue.pvd"));
  for (const char* name : {"skin_notes.txt", "summary.json", "my_skin_0001.vtp"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / name)) << name;
  }
}

TEST_F(ResultFolderTest, AFileInTheWayIsBadInput) {
  EXPECT_EQ(ResultFolder(write("file", "x") / "out").prepare().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace lipofill::client
