#include "client/cpp/volume/invesalius.h"

#include <gmock/gmock.h>

#include "client/cpp/json_file.h"
#include "client/cpp/volume/skin_extraction.h"
#include "temporary_folder.h"
#include "test_volumes.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

/// One file of a tar: header, contents, padding.
std::string tar_file(const std::string& name, const std::string& contents) {
  std::string header(512, '\0');
  name.copy(header.data(), 100);
  snprintf(header.data() + 124, 12, "%011o", static_cast<unsigned>(contents.size()));
  header[156] = '0';
  header.replace(148, 8, "        ");
  unsigned sum = 0;
  for (const char c : header) sum += static_cast<unsigned char>(c);
  snprintf(header.data() + 148, 8, "%06o", sum);
  return header + contents + std::string((512 - contents.size() % 512) % 512, '\0');
}

std::string plist(const std::string& shape, const std::string& dtype = "int16") {
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE plist PUBLIC "-//Apple Computer//DTD PLIST 1.0//EN" "http://www.apple.com/DTDs/PropertyList-1.0.dtd">
<plist version="1.0"><dict><key>matrix</key><dict><key>dtype</key><string>)" +
         dtype + "</string><key>filename</key><string>matrix.dat</string><key>shape</key><array>" + shape +
         "</array></dict><key>orientation</key><integer>1</integer><key>spacing</key><array><real>0.5</"
         "real><real>0.75</real>"
         "<real>2.0</real></array></dict></plist>";
}

constexpr char kShape[] = "<integer>2</integer><integer>3</integer><integer>4</integer>";

/// 2 slices of 3 rows of 4 columns, each voxel its own index.
std::string matrix() {
  std::string bytes;
  for (int16_t i = 0; i < 24; ++i) bytes.append(reinterpret_cast<const char*>(&i), 2);
  return bytes;
}

class InvesaliusTest : public TemporaryFolderTest {
 protected:
  std::string refusal_of(const std::string& project) {
    const auto volume = convert_invesalius(write("a.inv3", project), folder_ / "a.mha");
    EXPECT_EQ(volume.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.mha"));
    return std::string(volume.status().message());
  }
};

TEST_F(InvesaliusTest, RowsThatCountForwardAreTurnedToTheBack) {
  const std::string tar =
      tar_file("x/matrix.dat", matrix()) + tar_file("x/main.plist", plist(kShape)) + std::string(1024, '\0');
  const auto volume = convert_invesalius(write("a.inv3", gzipped(tar)), folder_ / "a.mha");
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_EQ(volume->size, (std::array<uint64_t, 3>{4, 3, 2}));
  EXPECT_EQ(volume->spacing_mm, (std::array<double, 3>{0.5, 0.75, 2.0}));
  const std::string text = *read_text_file(folder_ / "a.mha");
  EXPECT_THAT(text, HasSubstr("DimSize = 4 3 2\n"));
  EXPECT_THAT(text, HasSubstr("Offset = 0 -1.5 0\n"));
  EXPECT_THAT(text, HasSubstr("ElementSpacing = 0.5 0.75 2\n"));
  // Voxel (column 1, row 2, slice 1) of the project, at y = -1.5, is the file's (1, 0, 1).
  const std::string voxels = text.substr(text.size() - 48);
  int16_t value = 0;
  std::memcpy(&value, voxels.data() + 2 * (1 + 4 * (0 + 3 * 1)), 2);
  EXPECT_EQ(value, 1 + 4 * (2 + 3 * 1));
}

TEST_F(InvesaliusTest, RefusesWhatIsNoSuchProject) {
  EXPECT_THAT(refusal_of("nonsense"), HasSubstr("not an InVesalius project"));
  EXPECT_THAT(refusal_of(gzipped(std::string(2048, 'x'))), HasSubstr("not a tar"));
  EXPECT_THAT(refusal_of(gzipped(tar_file("x/other", "y") + std::string(1024, '\0'))),
              HasSubstr("holds no main.plist"));
  EXPECT_THAT(refusal_of(gzipped(tar_file("x/main.plist", "<plist") + std::string(1024, '\0'))),
              HasSubstr("no matrix"));
  EXPECT_THAT(refusal_of(gzipped(tar_file("x/main.plist", plist(kShape, "float64")))), HasSubstr("not int16"));
  const std::string wrong = plist("<integer>9</integer><integer>3</integer><integer>4</integer>");
  EXPECT_THAT(refusal_of(gzipped(tar_file("x/main.plist", wrong) + tar_file("x/matrix.dat", matrix()))),
              HasSubstr("asks for 216"));
  const std::string whole = gzipped(tar_file("x/main.plist", plist(kShape)) + tar_file("x/matrix.dat", matrix()));
  EXPECT_THAT(refusal_of(whole.substr(0, whole.size() - 30)), HasSubstr("cut short"));
}

TEST_F(InvesaliusTest, TheExampleHeadHasSkin) {
  const std::filesystem::path head = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
  if (!std::filesystem::exists(head)) GTEST_SKIP() << "package invesalius-examples is not installed";
  ASSERT_TRUE(convert_invesalius(head, folder_ / "head.mha").ok());
  const auto skin = extract_skin(folder_ / "head.mha", folder_ / "head.ply", SkinExtraction{});
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_GT(skin->triangles, 200'000u);
  // A head: wider than 140 mm, longer than 180 mm, its 159 mm from crown to upper lip.
  EXPECT_NEAR(skin->bounds_mm[1] - skin->bounds_mm[0], 190.0, 20.0);
  EXPECT_NEAR(skin->bounds_mm[3] - skin->bounds_mm[2], 222.0, 20.0);
  EXPECT_EQ(skin->frame, "LPS");
}

}  // namespace
}  // namespace lipofill::client
