#include "client/cpp/volume/invesalius.h"

#include <gmock/gmock.h>

#include "client/cpp/json_file.h"
#include "client/cpp/volume/skin_extraction.h"
#include "temporary_folder.h"
#include "test_volumes.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

/// The header of one file of a tar, which claims to hold `size` bytes.
std::string tar_header(const std::string& name, uint64_t size, char type = '0') {
  std::string header(512, '\0');
  name.copy(header.data(), 100);
  snprintf(header.data() + 124, 12, "%011llo", static_cast<unsigned long long>(size));
  header[156] = type;
  header.replace(148, 8, "        ");
  unsigned sum = 0;
  for (const char c : header) sum += static_cast<unsigned char>(c);
  snprintf(header.data() + 148, 8, "%06o", sum);
  return header;
}

/// One file of a tar: header, contents, padding.
std::string tar_file(const std::string& name, const std::string& contents, char type = '0') {
  return tar_header(name, contents.size(), type) + contents + std::string((512 - contents.size() % 512) % 512, '\0');
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

/// Neither gzip nor a name within 100 bytes is asked for; a folder of the right name is no file.
TEST_F(InvesaliusTest, ReadsWhateverTarWrites) {
  const std::string path = std::string(200, 'f') + "/main.plist";
  const std::string record = " path=" + path + "\n";
  const std::string length = std::to_string(record.size() + 3);
  const std::string tar = tar_file("x/main.plist", "", '5') + tar_file("pax", length + record, 'x') +
                          tar_file("cut", plist(kShape)) + tar_file("x/matrix.dat", matrix()) + std::string(1024, '\0');
  const auto volume = convert_invesalius(write("a.inv3", tar), folder_ / "a.mha");
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_EQ(volume->size, (std::array<uint64_t, 3>{4, 3, 2}));
}

/// Refused by what they claim, before anything of it is unpacked or reserved.
TEST_F(InvesaliusTest, RefusesWhatUnpacksToTooMuch) {
  EXPECT_THAT(refusal_of(gzipped(tar_file("x/main.plist", std::string(2 << 20, ' ')) + std::string(1024, '\0'))),
              HasSubstr("main.plist of 2097152 bytes, must have at most 1048576"));
  const uint64_t eight_gibibytes = (uint64_t{1} << 33) - 512;  // the most that a plain header can say
  std::string bomb;
  for (int k = 0; k < 3; ++k) bomb += tar_header("x/zeros", eight_gibibytes);
  EXPECT_THAT(refusal_of(gzipped(bomb)), HasSubstr("cut short"));
  std::string pax = tar_file("pax", "25 size=1099511627776123\n", 'x') + tar_header("x/zeros", 0);
  EXPECT_THAT(refusal_of(gzipped(pax + std::string(1024, '\0'))),
              HasSubstr("claims to hold more than the 17179869184 bytes allowed"));
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
