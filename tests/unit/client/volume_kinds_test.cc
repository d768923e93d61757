// What programs in the wild write into MetaImage, NRRD and NIfTI beyond the plain form that
// volume_test.cc reads: each is the same ball.

#include <bzlib.h>

#include <algorithm>
#include <limits>

#include "ball_fixture.h"
#include "client/cpp/volume/value_range.h"

namespace lipofill::client {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr std::array<double, 3> kCentre{20, 22, 24};
constexpr std::array<double, 3> kNrrdCentre{25, 28, 31};
constexpr std::array<double, 3> kNiftiCentre{-10, -25, 24};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// The ball's voxels as another type.
template <typename T>
std::string voxels_as(const BallVolume& ball) {
  std::string bytes;
  for (const int16_t voxel : ball.voxels()) {
    const T value = static_cast<T>(voxel);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return bytes;
}

std::string voxels_as_text(const BallVolume& ball) {
  std::string text;
  for (const int16_t voxel : ball.voxels()) text += std::to_string(voxel) + (text.size() % 7 == 0 ? "\n" : " ");
  return text;
}

std::string voxels_as_hex(const BallVolume& ball) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : ball.bytes()) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
    if (text.size() % 81 == 80) text += '\n';
  }
  return text;
}

std::string bzipped(std::string data) {
  auto size = static_cast<unsigned>(data.size() + data.size() / 50 + 1000);
  std::string packed(size, '\0');
  BZ2_bzBuffToBuffCompress(packed.data(), &size, data.data(), static_cast<unsigned>(data.size()), 9, 0, 0);
  packed.resize(size);
  return packed;
}

/// Two gzip members, as bgzip and pigz make them.
std::string gzipped_twice(const std::string& data) {
  const size_t half = data.size() / 2;
  return gzipped(data.substr(0, half)) + gzipped(data.substr(half));
}

/// A header in front of voxels that are not the ball's plain ones.
std::string with_voxels(const std::string& volume, const std::string& voxels) {
  return volume.substr(0, volume.size() - BallVolume().bytes().size()) + voxels;
}

template <typename T>
void put(std::string* bytes, size_t offset, T value) {
  std::memcpy(bytes->data() + offset, &value, sizeof value);
}

template <typename T>
std::string nifti_of(int16_t datatype, const std::string& voxels) {
  std::string bytes = with_voxels(nifti(BallVolume()), voxels);
  put(&bytes, 70, datatype);
  put(&bytes, 72, static_cast<int16_t>(8 * sizeof(T)));
  return bytes;
}

/// A NIfTI-2 file with the sform of test_volumes.h.
std::string nifti2(const BallVolume& ball) {
  std::string bytes(544, '\0');
  put(&bytes, 0, int32_t{540});
  std::memcpy(bytes.data() + 4, "n+2\0\r\n\032\n", 8);
  put(&bytes, 12, int16_t{4});
  const int64_t dim[] = {3, 40, 36, 32, 1, 1, 1, 1};
  std::memcpy(bytes.data() + 16, dim, sizeof dim);
  const double pixdim[] = {1, 1, 1.25, 1.5, 0, 0, 0, 0};
  std::memcpy(bytes.data() + 104, pixdim, sizeof pixdim);
  put(&bytes, 168, int64_t{544});
  put(&bytes, 348, int32_t{2});
  const double sform[] = {1, 0, 0, -10, 0, 1.25, 0, 3, 0, 0, 1.5, 0};
  std::memcpy(bytes.data() + 400, sform, sizeof sform);
  return bytes + ball.bytes();
}

/// The sform of test_volumes.h said as a qform: no rotation, spacing and offset.
std::string with_qform(std::string bytes) {
  put(&bytes, 252, int16_t{1});
  put(&bytes, 268, -10.0F);
  put(&bytes, 272, 3.0F);
  return bytes;
}

class VolumeKindsTest : public BallTest {
 protected:
  const BallVolume ball_;
  const std::string nrrd_ = nrrd(ball_, "left-posterior-superior", "raw");
  std::string encoded(const std::string& encoding, const std::string& voxels) const {
    return with_voxels(replaced(nrrd_, "encoding: raw", "encoding: " + encoding), voxels);
  }
  std::vector<std::string> remarks_of(const std::string& name) const {
    const auto volume = read_volume(folder_ / name);
    EXPECT_TRUE(volume.ok()) << volume.status();
    return volume.ok() ? volume->remarks : std::vector<std::string>();
  }
};

TEST_F(VolumeKindsTest, SeveralGzipMembers) {
  expect_ball("a.nii.gz", gzipped_twice(nifti(ball_)), kNiftiCentre);
  expect_ball("a.nrrd", encoded("gzip", gzipped_twice(ball_.bytes())), kNrrdCentre);
  const std::string packed = replaced(metaimage(ball_), "Offset", "CompressedData = True\nOffset");
  expect_ball("a.mha", with_voxels(packed, gzipped_twice(ball_.bytes())), kCentre);
  // A byte that changed on the way changes the sum at the end of its member.
  for (const size_t from_end : {6, 900}) {
    std::string damaged = gzipped_twice(ball_.bytes());
    damaged[damaged.size() - from_end] = static_cast<char>(damaged[damaged.size() - from_end] ^ 0x55);
    EXPECT_THAT(refusal_of("damaged.nrrd", encoded("gzip", damaged)), HasSubstr("is damaged"));
  }
  expect_ball("padded.nii.gz", gzipped(nifti(ball_)) + std::string(512, '\0'), kNiftiCentre);
}

TEST_F(VolumeKindsTest, EveryTypeOfNumber) {
  expect_ball("a.nii", nifti_of<int64_t>(1024, voxels_as<int64_t>(ball_)), kNiftiCentre);
  expect_ball("b.nii", nifti_of<double>(64, voxels_as<double>(ball_)), kNiftiCentre);
  expect_ball("a.nrrd", with_voxels(replaced(nrrd_, "type: short", "type: long long int"), voxels_as<int64_t>(ball_)),
              kNrrdCentre);
  expect_ball("b.nrrd", replaced(nrrd_, "type: short", "type: Signed  Short Int"), kNrrdCentre);
  for (const auto& [type, voxels] : {std::pair{std::string("MET_LONG_LONG"), voxels_as<int64_t>(ball_)},
                                     {"MET_LONG", voxels_as<int32_t>(ball_)},
                                     {"MET_FLOAT", voxels_as<float>(ball_)}})
    expect_ball("a.mha", with_voxels(replaced(metaimage(ball_), "MET_SHORT", type), voxels), kCentre);
}

TEST_F(VolumeKindsTest, EveryEncodingOfNrrd) {
  expect_ball("bz2.nrrd", encoded("bzip2", bzipped(ball_.bytes())), kNrrdCentre);
  expect_ball("ascii.nrrd", encoded("ascii", voxels_as_text(ball_)), kNrrdCentre);
  expect_ball("hex.nrrd", encoded("hex", voxels_as_hex(ball_)), kNrrdCentre);
  EXPECT_THAT(refusal_of("bad.nrrd", encoded("ascii", "1 2 three")), HasSubstr("\"three\""));
  EXPECT_THAT(refusal_of("wide.nrrd", encoded("ascii", "1 2 40000")), HasSubstr("\"40000\""));
  EXPECT_THAT(refusal_of("few.nrrd", encoded("ascii", "1 2 3")), HasSubstr("6 are there"));
  EXPECT_THAT(refusal_of("odd.nrrd", encoded("hex", "12 3g")), HasSubstr("no hexadecimal digit"));
  EXPECT_THAT(refusal_of("raw.nrrd", encoded("bzip2", ball_.bytes())), HasSubstr("not bzip2"));
  EXPECT_THAT(refusal_of("zip.nrrd", encoded("zip", ball_.bytes())), HasSubstr("encoding \"zip\""));
}

TEST_F(VolumeKindsTest, DetachedHeadersAndSkips) {
  write("a.raw", "one line\nanother\n" + std::string(5, 'x') + ball_.bytes());
  const std::string head = with_voxels(nrrd_, "");
  expect_ball("a.nhdr", replaced(head, "endian", "data file: a.raw\nline skip: 2\nbyte skip: 5\nendian"), kNrrdCentre);
  expect_ball("b.nhdr", replaced(head, "endian", "datafile: a.raw\nbyteskip: -1\nendian"), kNrrdCentre);
  write("a.gz", gzipped("12345" + ball_.bytes()));
  expect_ball("c.nhdr", replaced(replaced(head, "endian", "data file: a.gz\nbyte skip: 5\nendian"), "raw\n", "gzip\n"),
              kNrrdCentre);
  expect_ball("d.nhdr", replaced(replaced(head, "endian", "data file: a.gz\nbyte skip: -1\nendian"), "raw\n", "gzip\n"),
              kNrrdCentre);
  const std::string local = with_voxels(metaimage(ball_), "");
  for (const char* header_size : {"22", "-1"}) {
    expect_ball(
        "a.mhd",
        replaced(replaced(local, "LOCAL", "a.raw"), "Offset", "HeaderSize = " + std::string(header_size) + "\nOffset"),
        kCentre);
  }
  EXPECT_THAT(refusal_of("far.nhdr", replaced(head, "endian", "data file: a.raw\nline skip: 99999999\nendian")),
              HasSubstr("fewer lines"));
}

TEST_F(VolumeKindsTest, SlicesInFilesOfTheirOwn) {
  const std::string voxels = ball_.bytes();
  const size_t slice = voxels.size() / 32;
  std::string list;
  for (size_t k = 0; k < 32; ++k) {
    const std::string name = "s" + std::string(k < 9 ? "0" : "") + std::to_string(k + 1) + ".raw";
    write(name, voxels.substr(k * slice, slice));
    list += name + "\n";
  }
  const std::string local = with_voxels(metaimage(ball_), "");
  expect_ball("list.mhd", replaced(local, "LOCAL\n", "LIST\n" + list), kCentre);
  expect_ball("pattern.mhd", replaced(local, "LOCAL", "s%02d.raw 1 32 1"), kCentre);
  std::string head = with_voxels(nrrd_, "");
  head.pop_back();
  expect_ball("list.nhdr", head + "data file: LIST\n" + list, kNrrdCentre);
  expect_ball("pattern.nhdr", head + "data file: s%02d.raw 1 32 1\n", kNrrdCentre);
  EXPECT_THAT(refusal_of("few.mhd", replaced(local, "LOCAL", "s%02d.raw 1 31 1")), HasSubstr("cannot share"));
  EXPECT_THAT(refusal_of("hostile.mhd", replaced(local, "LOCAL", "s%s%n.raw 1 32 1")), HasSubstr("must have one %d"));
  EXPECT_THAT(refusal_of("gone.mhd", replaced(local, "LOCAL", "t%02d.raw 1 32 1")), HasSubstr("t01.raw"));
}

TEST_F(VolumeKindsTest, NotesAndSpellings) {
  expect_ball("note.nrrd", replaced(nrrd_, "dimension", "type:=axial CT\nspace:=none\ndimension"), kNrrdCentre);
  std::string capitals = replaced(nrrd_, "space: left-posterior-superior", "Space: Left-Posterior-Superior");
  expect_ball("capitals.nrrd", replaced(capitals, "type: short", "Type: SHORT"), kNrrdCentre);
  expect_ball("crlf.nrrd", replaced(nrrd_, "# a ball\n", "# a ball\r\ncontent: a ball\r\n"), kNrrdCentre);
  // A slip of the pen would put the head elsewhere.
  EXPECT_THAT(refusal_of("slip.nrrd", replaced(nrrd_, "space origin", "space orgin")),
              HasSubstr("\"space orgin: (5,6,7)\""));
  EXPECT_THAT(refusal_of("space.nrrd", replaced(nrrd_, "left-posterior", "left-postrior")),
              HasSubstr("has space \"left-postrior"));
  expect_ball("bom.mha", "\xEF\xBB\xBF" + metaimage(ball_), kCentre);
  std::string colons = replaced(metaimage(ball_), "ElementSpacing =", "\nElementSize :");
  colons = replaced(colons, "TransformMatrix", "Rotation");
  expect_ball("colons.mha", replaced(colons, "Offset", "Position"), kCentre);
  expect_ball("text.mha",
              with_voxels(replaced(metaimage(ball_), "BinaryData = True", "BinaryData = False"), voxels_as_text(ball_)),
              kCentre);
}

TEST_F(VolumeKindsTest, FourDimensionsOfOneFrame) {
  std::string four = replaced(metaimage(ball_), "NDims = 3", "NDims = 4");
  four = replaced(four, "1 0 0 0 1 0 0 0 1", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  four = replaced(replaced(four, "Offset = 0 0 0", "Offset = 0 0 0 0"), "1 1.25 1.5", "1 1.25 1.5 1");
  expect_ball("a.mha", replaced(four, "DimSize = 40 36 32", "DimSize = 40 36 32 1"), kCentre);
  EXPECT_THAT(refusal_of("b.mha", replaced(four, "DimSize = 40 36 32", "DimSize = 40 36 16 2")),
              HasSubstr("40 x 36 x 16 x 2, more than one volume"));
  std::string listed = replaced(replaced(nrrd_, "dimension: 3", "dimension: 4"), "sizes: ", "sizes: 1 ");
  expect_ball("a.nrrd", replaced(listed, "directions: ", "directions: none "), kNrrdCentre);
  std::string timed = replaced(replaced(nrrd_, "dimension: 3", "dimension: 4"), "40 36 32", "40 36 32 1");
  timed = replaced(timed, "(1,0,0) (0,1.25,0) (0,0,1.5)", "(1,0,0) (0,1.25,0) (0,0,1.5) (nan,nan,nan)");
  expect_ball("b.nrrd", timed, kNrrdCentre);
  std::string four_nifti = nifti(ball_);
  put(&four_nifti, 40, int16_t{4});
  expect_ball("a.nii", four_nifti, kNiftiCentre);
  put(&four_nifti, 46, int16_t{16});
  put(&four_nifti, 48, int16_t{2});
  EXPECT_THAT(refusal_of("b.nii", four_nifti), HasSubstr("more than one volume"));
}

TEST_F(VolumeKindsTest, AVoxelThatIsNoNumberIsAir) {
  // Everything at air becomes a NaN, and one voxel outside an infinity below zero.
  auto voxels = ball_.voxels();
  std::string bytes;
  for (size_t k = 0; k < voxels.size(); ++k) {
    float value = voxels[k] == -1000 ? std::numeric_limits<float>::quiet_NaN() : voxels[k];
    if (k == 0) value = -std::numeric_limits<float>::infinity();
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  expect_ball("a.nii", nifti_of<float>(16, bytes), kNiftiCentre);
  EXPECT_THAT(remarks_of("a.nii"), Contains(HasSubstr("taken for air")));
  expect_ball("a.nrrd", with_voxels(replaced(nrrd_, "type: short", "type: float"), bytes), kNrrdCentre);
  expect_ball("a.mha", with_voxels(replaced(metaimage(ball_), "MET_SHORT", "MET_FLOAT"), bytes), kCentre);
  const std::string none(4 * voxels.size(), '\xff');
  const auto volume =
      read_volume(write("none.mha", with_voxels(replaced(metaimage(ball_), "MET_SHORT", "MET_FLOAT"), none)));
  EXPECT_THAT(std::string(volume.status().message()), HasSubstr("no voxel that is a finite number"));
}

TEST_F(VolumeKindsTest, Units) {
  for (const auto& [code, factor] : {std::pair{1, 1e-3}, {3, 1e3}, {2, 1.0}, {0, 1.0}}) {
    std::string bytes = nifti(ball_);
    bytes[123] = static_cast<char>(code | 8);
    for (size_t k = 0; k < 12; ++k) {
      float entry;
      std::memcpy(&entry, bytes.data() + 280 + 4 * k, 4);
      put(&bytes, 280 + 4 * k, static_cast<float>(entry * factor));
    }
    expect_ball("a.nii", bytes, kNiftiCentre);
  }
  std::string metres = replaced(nrrd_, "(1,0,0) (0,1.25,0) (0,0,1.5)", "(0.001,0,0) (0,0.00125,0) (0,0,0.0015)");
  metres = replaced(metres, "(5,6,7)", "(0.005,0.006,0.007)");
  expect_ball("m.nrrd", replaced(metres, "kinds", "space units: \"m\" \"m\" \"m\"\nkinds"), kNrrdCentre);
  expect_ball("odd.nrrd", replaced(nrrd_, "kinds", "space units: \"foo\" \"mm\" \"mm\"\nkinds"), kNrrdCentre);
  EXPECT_THAT(remarks_of("odd.nrrd"), Contains(HasSubstr("unit \"foo\"")));
  std::string axes = replaced(nrrd_, "space: left-posterior-superior\n", "");
  axes = replaced(axes, "space directions: (1,0,0) (0,1.25,0) (0,0,1.5)",
                  "spacings: 0.1 0.125 0.15\nunits: \"cm\" \"cm\" \"cm\"");
  expect_ball("cm.nrrd", replaced(axes, "space origin: (5,6,7)\n", ""), kCentre);
}

TEST_F(VolumeKindsTest, NrrdAxesByTheirEnds) {
  std::string axes = replaced(nrrd_, "space: left-posterior-superior\n", "");
  axes = replaced(axes, "space origin: (5,6,7)\n", "");
  const std::string directions = "space directions: (1,0,0) (0,1.25,0) (0,0,1.5)";
  expect_ball("node.nrrd",
              replaced(axes, directions, "axis mins: 0 0 0\naxis maxs: 39 43.75 46.5\ncenters: node node node"),
              kCentre);
  expect_ball(
      "cell.nrrd",
      replaced(axes, directions, "axismins: -0.5 -0.625 -0.75\naxismaxs: 39.5 44.375 47.25\ncenters: cell cell cell"),
      kCentre);
}

TEST_F(VolumeKindsTest, SecondVersionOfNifti) {
  expect_ball("a.nii", nifti2(ball_), kNiftiCentre);
  expect_ball("a.nii.gz", gzipped(nifti2(ball_)), kNiftiCentre);
  expect_ball("a.nii.bz2", bzipped(nifti2(ball_)), kNiftiCentre);
}

TEST_F(VolumeKindsTest, NiftiInTwoFiles) {
  std::string bytes = nifti(ball_);
  std::memcpy(bytes.data() + 344, "ni1", 4);
  put(&bytes, 108, 0.0F);
  write("a.img", ball_.bytes());
  expect_ball("a.hdr", bytes.substr(0, 348), kNiftiCentre);
  write("b.img.gz", gzipped(ball_.bytes()));
  expect_ball("b.hdr.gz", gzipped(bytes.substr(0, 348)), kNiftiCentre);
  EXPECT_THAT(refusal_of("c.hdr", bytes.substr(0, 348)), HasSubstr("c.img"));
}

TEST_F(VolumeKindsTest, NiftiQformAndSform) {
  std::string bytes = with_qform(nifti(ball_));
  put(&bytes, 254, int16_t{0});
  expect_ball("q.nii", bytes, kNiftiCentre);
  // A negative voxel size counts without its sign; that of pixdim[0] turns the third axis.
  put(&bytes, 80, -1.0F);
  put(&bytes, 88, -1.5F);
  expect_ball("negative.nii", bytes, kNiftiCentre);
  EXPECT_THAT(remarks_of("negative.nii"), Contains(HasSubstr("pixdim[1] is -1")));
  put(&bytes, 76, -1.0F);
  expect_ball("turned.nii", bytes, {-10, -25, -24});
  // The sform is there and says nothing.
  bytes = with_qform(nifti(ball_));
  std::fill_n(bytes.begin() + 280, 48, '\0');
  expect_ball("zero.nii", bytes, kNiftiCentre);
  EXPECT_THAT(remarks_of("zero.nii"), Contains(HasSubstr("sform does not span space")));
  // Half a turn about x: y and z change their signs.
  bytes = with_qform(nifti(ball_));
  put(&bytes, 254, int16_t{0});
  put(&bytes, 256, 1.0F);
  expect_ball("half_turn.nii", bytes, {-10, 19, -24});
  put(&bytes, 256, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(refusal_of("nan.nii", bytes), HasSubstr("not finite"));
}

TEST_F(VolumeKindsTest, NiftiScaling) {
  std::string bytes = nifti(ball_);
  put(&bytes, 112, std::numeric_limits<float>::quiet_NaN());
  put(&bytes, 116, std::numeric_limits<float>::quiet_NaN());
  expect_ball("nan.nii", bytes, kNiftiCentre);
  // Voxels -2 v - 400, of which slope and intercept make v again.
  std::string voxels;
  for (const int16_t voxel : ball_.voxels()) {
    const auto stored = static_cast<int16_t>(-2 * voxel - 400);
    voxels.append(reinterpret_cast<const char*>(&stored), 2);
  }
  bytes = with_voxels(nifti(ball_), voxels);
  put(&bytes, 112, -0.5F);
  put(&bytes, 116, -200.0F);
  expect_ball("scaled.nii", bytes, kNiftiCentre);
}

TEST_F(VolumeKindsTest, NiftiOffsets) {
  std::string bytes = nifti(ball_);
  put(&bytes, 108, 0.0F);
  expect_ball("zero.nii", bytes, kNiftiCentre);
  put(&bytes, 108, 368.0F);
  expect_ball("extended.nii", bytes.substr(0, 352) + std::string(16, 'e') + ball_.bytes(), kNiftiCentre);
  put(&bytes, 108, 12.0F);
  EXPECT_THAT(refusal_of("within.nii", bytes), HasSubstr("vox_offset 12"));
}

TEST_F(VolumeKindsTest, LabelsOfALabelMap) {
  // Within the ball 3 to the left of its middle, else 5; outside 0.
  std::string voxels;
  const auto values = ball_.voxels();
  for (size_t k = 0; k < values.size(); ++k) {
    const int16_t label = values[k] < -500 ? 0 : k % 40 <= 20 ? 3 : 5;
    voxels.append(reinterpret_cast<const char*>(&label), 2);
  }
  const auto file = write("map.mha", with_voxels(metaimage(ball_), voxels));
  SkinExtraction options;
  options.labels = {"3"};
  const auto half = extract_skin(file, folder_ / "half.ply", options);
  ASSERT_TRUE(half.ok()) << half.status();
  EXPECT_NEAR(half->bounds_mm[0], 20 - 14, 0.51);
  EXPECT_NEAR(half->bounds_mm[1], 20.5, 1e-6);
  options.labels = {"3", "5"};
  const auto both = extract_skin(file, folder_ / "both.ply", options);
  ASSERT_TRUE(both.ok()) << both.status();
  EXPECT_NEAR(both->bounds_mm[1], 20 + 14, 0.51);
  options.labels = {"4"};
  EXPECT_THAT(std::string(extract_skin(file, folder_ / "none.ply", options).status().message()),
              HasSubstr("no voxel of label 4; its labels are 0, 3, 5"));
}

TEST_F(VolumeKindsTest, ProposesAValueBetweenAirAndTissue) {
  const auto volume = read_volume(write("a.mha", metaimage(ball_)));
  ASSERT_TRUE(volume.ok());
  const ValueRange range = find_value_range(*volume);
  EXPECT_EQ(range.least, -1000.0);
  EXPECT_EQ(range.most, 0.0);
  EXPECT_GT(range.threshold, -900.0);
  EXPECT_LT(range.threshold, -100.0);
  const std::string flat(ball_.bytes().size(), '\0');
  const auto skin =
      extract_skin(write("flat.mha", with_voxels(metaimage(ball_), flat)), folder_ / "skin.ply", at_500());
  EXPECT_THAT(std::string(skin.status().message()), HasSubstr("all of its voxels have the value 0"));
}

}  // namespace
}  // namespace lipofill::client
