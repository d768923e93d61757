// What is said and drawn of a volume before anything is made of it.

#include "client/cpp/volume/volume_facts.h"

#include <gmock/gmock.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <array>
#include <string>

#include "ball_fixture.h"

namespace lipofill::client {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class VolumeFactsTest : public BallTest {
 protected:
  const BallVolume ball_;

  /// The ball as a label map: 2 within it, 0 outside.
  std::string label_map() const {
    std::string bytes = metaimage(ball_);
    bytes.resize(bytes.size() - ball_.bytes().size());
    for (const int16_t value : ball_.voxels()) {
      const int16_t label = value < -500 ? 0 : 2;
      bytes.append(reinterpret_cast<const char*>(&label), 2);
    }
    return bytes;
  }

  /// The picture's size, and the colours in the middle of its first panel and in the corner there.
  std::array<std::array<int, 3>, 3> picture_of(const Volume& volume) {
    const auto png = folder_ / "slices.png";
    EXPECT_TRUE(draw_slices(volume, find_volume_facts(volume), png).ok());
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(png.c_str());
    reader->Update();
    std::array<int, 3> size{};
    reader->GetOutput()->GetDimensions(size.data());
    const auto pixel = [&](int x, int from_top) {
      const auto* at = static_cast<uint8_t*>(reader->GetOutput()->GetScalarPointer(x, size[1] - 1 - from_top, 0));
      return std::array<int, 3>{at[0], at[1], at[2]};
    };
    return {size, pixel(12 + 250, 12 + 280), pixel(14, 14)};
  }
};

TEST_F(VolumeFactsTest, SizeSpacingValuesAndNoLabelsOfACt) {
  const auto volume = read_volume(write("ct.mha", metaimage(ball_)));
  ASSERT_TRUE(volume.ok());
  const VolumeFacts facts = find_volume_facts(*volume);
  EXPECT_THAT(facts.size, ElementsAre(40, 36, 32));
  EXPECT_THAT(facts.spacing_mm, ElementsAre(1.0, 1.25, 1.5));
  EXPECT_EQ(facts.values.least, -1000.0);
  EXPECT_THAT(facts.labels, IsEmpty());
  const auto [size, middle, corner] = picture_of(*volume);
  // 40 mm, 45 mm and 48 mm at 600 pixels for the longest.
  EXPECT_THAT(size, ElementsAre(500 + 500 + 562 + 4 * 12, 600 + 2 * 12, 1));
  EXPECT_THAT(middle, ElementsAre(255, 255, 255));
  EXPECT_THAT(corner, ElementsAre(0, 0, 0));
}

TEST_F(VolumeFactsTest, LabelsAreCountedAndColoured) {
  const auto volume = read_volume(write("map.mha", label_map()));
  ASSERT_TRUE(volume.ok());
  const VolumeFacts facts = find_volume_facts(*volume);
  ASSERT_EQ(facts.labels.size(), 2u);
  const double ml = facts.voxel_ml * static_cast<double>(facts.labels.at(2));
  EXPECT_NEAR(ml, 4.0 / 3.0 * M_PI * 1.4 * 1.4 * 1.4, 0.1);
  const auto [size, middle, corner] = picture_of(*volume);
  EXPECT_THAT(middle, ElementsAre(86, 180, 233));
  EXPECT_THAT(corner, ElementsAre(0, 0, 0));
}

TEST_F(VolumeFactsTest, APictureThatCannotBeWrittenIsSaid) {
  const auto volume = read_volume(write("map.mha", label_map()));
  EXPECT_FALSE(draw_slices(*volume, find_volume_facts(*volume), folder_ / "none" / "a.png").ok());
}

}  // namespace
}  // namespace lipofill::client
