#include <gmock/gmock.h>
#include <vtkNew.h>
#include <vtkPLYReader.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>

#include "ball_fixture.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

class VolumeTest : public BallTest {};

TEST_F(VolumeTest, BallInMetaImage) {
  const BallVolume ball;
  expect_ball("a.mha", metaimage(ball), {20, 22, 24});
  expect_ball("big.mha", big_endian(metaimage(ball), ball, "ByteOrderMSB = False", "ByteOrderMSB = True"),
              {20, 22, 24});
  std::string packed = metaimage(ball);
  packed.replace(packed.size() - ball.bytes().size(), std::string::npos, gzipped(ball.bytes()));
  packed.insert(packed.find("Offset"), "CompressedData = True\n");
  expect_ball("packed.mha", packed, {20, 22, 24});
  // Row a of TransformMatrix is where index a points: here i to y, j to -x; offset added.
  expect_ball("turned.mha", metaimage(ball, "0 1 0 -1 0 0 0 0 1", "100 0 -50"), {100 - 22.0, 20, 24 - 50});
  // A left-handed grid: the triangles still face outwards.
  expect_ball("mirrored.mha", metaimage(ball, "1 0 0 0 -1 0 0 0 1"), {20, -22, 24});
}

TEST_F(VolumeTest, BallInNrrd) {
  const BallVolume ball;
  expect_ball("a.nrrd", nrrd(ball, "left-posterior-superior", "raw"), {25, 28, 31});
  expect_ball("gz.nrrd", nrrd(ball, "left-posterior-superior", "gzip"), {25, 28, 31});
  expect_ball("big.nrrd", big_endian(nrrd(ball, "left-posterior-superior", "raw"), ball, "little", "big"),
              {25, 28, 31});
  expect_ball("ras.nrrd", nrrd(ball, "right-anterior-superior", "raw"), {-25, -28, 31});
}

TEST_F(VolumeTest, BallInNifti) {
  const BallVolume ball;
  // RAS (20 - 10, 22 + 3, 24) is LPS (-10, -25, 24).
  expect_ball("a.nii", nifti(ball), {-10, -25, 24});
  expect_ball("a.nii.gz", gzipped(nifti(ball)), {-10, -25, 24});
}

TEST_F(VolumeTest, KeepsTheLargestPieceSmoothsAndThins) {
  BallVolume ball;
  std::string bytes = metaimage(ball);
  // A speck of tissue in a corner, away from the ball.
  const size_t voxels = bytes.size() - ball.bytes().size();
  const int16_t tissue = 0;
  std::memcpy(bytes.data() + voxels + 2 * (2 + 40 * (2 + 36 * 2)), &tissue, 2);
  const auto file = write("speck.mha", bytes);
  SkinExtraction options = at_500();
  const auto largest = extract_skin(file, folder_ / "a.stl", options);
  ASSERT_TRUE(largest.ok()) << largest.status();
  EXPECT_EQ(largest->components, 2);
  EXPECT_GT(largest->bounds_mm[0], 5.0);
  options.all_components = true;
  EXPECT_LT(extract_skin(file, folder_ / "b.stl", options)->bounds_mm[0], 3.0);
  options.all_components = false;
  options.smoothing_iterations = 10;
  options.target_triangles = 800;
  const auto thinned = extract_skin(file, folder_ / "c.obj", options);
  ASSERT_TRUE(thinned.ok());
  EXPECT_NEAR(static_cast<double>(thinned->triangles), 800.0, 8.0);
  vtkNew<vtkSTLReader> reader;
  reader->SetFileName((folder_ / "a.stl").c_str());
  reader->Update();
  EXPECT_EQ(static_cast<uint64_t>(reader->GetOutput()->GetNumberOfCells()), largest->triangles);
}

TEST_F(VolumeTest, ACornerOnAVoxelMakesNoTriangleWithoutArea) {
  // Whole voxels and a whole isovalue that many of them have exactly.
  const auto skin =
      extract_skin(write("a.mha", metaimage(BallVolume())), folder_ / "skin.ply", SkinExtraction{.isovalue = -375.0});
  ASSERT_TRUE(skin.ok());
  vtkNew<vtkPLYReader> reader;
  reader->SetFileName((folder_ / "skin.ply").c_str());
  reader->Update();
  for (vtkIdType c = 0; c < reader->GetOutput()->GetNumberOfCells(); ++c) {
    vtkIdType n = 0;
    const vtkIdType* ids = nullptr;
    reader->GetOutput()->GetCellPoints(c, n, ids);
    EXPECT_TRUE(ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0]);
  }
}

TEST_F(VolumeTest, RefusesTruncatedFiles) {
  const BallVolume ball;
  for (const auto& [name, bytes] : {std::pair{std::string("t.mha"), metaimage(ball)},
                                    {"t.nrrd", nrrd(ball, "left-posterior-superior", "raw")},
                                    {"tz.nrrd", nrrd(ball, "left-posterior-superior", "gzip")},
                                    {"t.nii", nifti(ball)},
                                    {"t.nii.gz", gzipped(nifti(ball))}}) {
    EXPECT_THAT(refusal_of(name, bytes.substr(0, bytes.size() * 3 / 4)), HasSubstr("is cut short")) << name;
  }
}

TEST_F(VolumeTest, RefusesAHeaderThatIsNoText) {
  std::string bytes = nrrd(BallVolume(), "left-posterior-superior", "raw");
  bytes.replace(bytes.find("kinds: domain"), 13, std::string("kinds: d\0\0\0\0\0", 13));
  EXPECT_THAT(refusal_of("zero.nrrd", bytes), HasSubstr("has a byte of 0 in its header"));
}

TEST_F(VolumeTest, RefusesGarbageAndHugeHeaders) {
  std::string garbage(5000, '\0');
  for (size_t i = 0; i < garbage.size(); ++i) garbage[i] = static_cast<char>(i * 7919 % 251);
  for (const char* name : {"g.mha", "g.nrrd", "g.nii", "g.nii.gz"}) {
    refusal_of(name, garbage);
    refusal_of(name, "");
  }
  const std::string huge =
      "ObjectType = Image\nNDims = 3\nDimSize = 60000 60000 60000\nElementType = MET_SHORT\nElementDataFile = "
      "LOCAL\nxx";
  EXPECT_THAT(refusal_of("huge.mha", huge), HasSubstr("more than the"));
  EXPECT_THAT(refusal_of("vast.mha", "DimSize = 1e300 2 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"),
              HasSubstr("not in [1, 65535]"));
  EXPECT_THAT(refusal_of("nan.mha", "DimSize = nan 2 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"),
              HasSubstr("three sizes"));
  EXPECT_THAT(refusal_of("away.mhd", "DimSize = 2 2 2\nElementType = MET_SHORT\nElementDataFile = none.raw\n"),
              HasSubstr("none.raw"));
  EXPECT_THAT(
      refusal_of("rgb.mha",
                 "DimSize = 2 2 2\nElementNumberOfChannels = 3\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"),
      HasSubstr("3 channels"));
  EXPECT_THAT(refusal_of("flat.mha", "NDims = 2\nDimSize = 2 2 2\nElementType = MET_CHAR\nElementDataFile = LOCAL\n"),
              HasSubstr("has NDims 2, and a DimSize of 3 numbers"));
  refusal_of("a.dcm", "DICM");
}

TEST_F(VolumeTest, SaysWhenThereIsNoSurface) {
  const auto file = write("a.mha", metaimage(BallVolume()));
  const auto skin = extract_skin(file, folder_ / "skin.ply", SkinExtraction{.isovalue = 5000.0});
  EXPECT_THAT(std::string(skin.status().message()), HasSubstr("no surface at the value 5000"));
  EXPECT_THAT(std::string(skin.status().message()), HasSubstr("its values go from -1000 to 0; try --isovalue -"));
  EXPECT_FALSE(extract_skin(file, folder_ / "skin.glb", at_500()).ok());
  EXPECT_FALSE(
      extract_skin(write("flat.mha", metaimage(BallVolume(), "1 0 0 1 0 0 0 0 1")), folder_ / "skin.ply", at_500())
          .ok());
}

}  // namespace
}  // namespace lipofill::client
