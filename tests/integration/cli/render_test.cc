// lipofill render: what a person sees on the sheet is looked for in its pixels.

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using Pixel = std::array<int, 3>;
using ::testing::HasSubstr;

/// The band of settled pressure, by its bounds in mmHg, and its colour.
struct Band {
  double from_pa;
  double to_pa;
  Pixel colour;
};
constexpr double kMmhg = 133.322;
const std::array<Band, 4> kBands = {{{-1e9, 9 * kMmhg, {168, 217, 184}},
                                     {9 * kMmhg, 15 * kMmhg, {245, 189, 66}},
                                     {15 * kMmhg, 30 * kMmhg, {217, 102, 26}},
                                     {30 * kMmhg, 1e9, {133, 8, 36}}}};

/// The same colour in another light: the same ratios of its parts.
bool is_shade_of(const Pixel& pixel, const Pixel& colour) {
  const double light = (pixel[0] + pixel[1] + pixel[2]) / static_cast<double>(colour[0] + colour[1] + colour[2]);
  double difference = 0.0;
  for (size_t c = 0; c < 3; ++c) difference = std::max(difference, std::abs(pixel[c] - light * colour[c]));
  return light > 0.5 && light < 1.3 && difference < 10.0;
}

bool is_grey(const Pixel& pixel) {
  return *std::max_element(pixel.begin(), pixel.end()) - *std::min_element(pixel.begin(), pixel.end()) < 12;
}

class RenderTest : public CliTest {
 protected:
  void read_sheet(const std::string& name) {
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName((folder_ / name).c_str());
    reader->Update();
    sheet_ = reader->GetOutput();
    sheet_->GetDimensions(size_.data());
  }

  Pixel pixel(int x, int y) const {
    Pixel value{};
    for (int c = 0; c < 3; ++c) {
      value[static_cast<size_t>(c)] = static_cast<int>(sheet_->GetScalarComponentAsDouble(x, y, 0, c));
    }
    return value;
  }

  /// The share of the pixels in a part of the sheet (as shares of it, from the lower left) of which
  /// `is` holds.
  template <typename Test>
  double share(double left, double bottom, double right, double top, const Test& is) const {
    int all = 0, found = 0;
    for (int y = static_cast<int>(bottom * size_[1]); y < static_cast<int>(top * size_[1]); ++y) {
      for (int x = static_cast<int>(left * size_[0]); x < static_cast<int>(right * size_[0]); ++x, ++all) {
        found += is(pixel(x, y)) ? 1 : 0;
      }
    }
    return static_cast<double>(found) / all;
  }

  double share_of_band(const Band& band) const {
    return share(0.385, 0.045, 0.77, 0.46, [&](const Pixel& p) { return is_shade_of(p, band.colour); });
  }

  /// Runs the small square with a skin of this modulus, draws it, and reads the sheet.
  void draw_with_modulus(double modulus_kpa) {
    write_plan("plate.json", "/model/layers/0/youngs_modulus_kpa", modulus_kpa);
    const CommandResult made = run("lipofill run plate.json --out out --spawn --discard --no-picture --quiet");
    ASSERT_EQ(made.exit_code, 0) << made.errors;
    const CommandResult drawn = run("lipofill render out");
    ASSERT_EQ(drawn.exit_code, 0) << drawn.errors;
    read_sheet("out/picture.png");
  }

  /// The band that the summary's pressure lies in, once its colour was found in the panel of the
  /// pressure.
  size_t expect_band_of_pressure() const {
    const double pressure_pa = read_json("out/summary.json")["mean_pressure_pa"];
    size_t i = 0;
    while (pressure_pa >= kBands[i].to_pa) ++i;
    EXPECT_GT(share_of_band(kBands[i]), 0.02) << "band " << i << " at " << pressure_pa << " Pa";
    return i;
  }

  int pixels_that_differ_after() const {
    int differing = 0;
    const int column = static_cast<int>(0.385 * size_[0]);
    for (int y = size_[1] / 2; y < static_cast<int>(0.9 * size_[1]); ++y) {
      for (int x = 0; x < column; ++x) {
        differing += std::abs(pixel(x, y)[0] - pixel(x + column, y)[0]) > 8 ? 1 : 0;
      }
    }
    return differing;
  }

  vtkSmartPointer<vtkImageData> sheet_;
  std::array<int, 3> size_{};
};

TEST_F(RenderTest, TheSheetShowsBeforeAfterDisplacementAndPressure) {
  draw_with_modulus(60.0);
  EXPECT_EQ(size_[0], 2000);
  EXPECT_EQ(size_[1], 1480);
  const auto is_skin = [](const Pixel& p) { return p[0] > p[1] + 20 && p[1] > p[2] + 8; };
  const auto is_coloured = [](const Pixel& p) { return !is_grey(p); };
  EXPECT_GT(share(0.0, 0.5, 0.385, 0.9, is_skin), 0.15) << "before";
  EXPECT_GT(share(0.385, 0.5, 0.77, 0.9, is_skin), 0.15) << "after";
  EXPECT_GT(share(0.0, 0.045, 0.385, 0.46, is_coloured), 0.02) << "displacement";
  EXPECT_GT(share(0.0, 0.045, 0.385, 0.46, is_grey), 0.4) << "what does not move";
  EXPECT_GT(share(0.78, 0.5, 1.0, 0.95, [](const Pixel& p) { return p[0] < 100; }), 0.005) << "figures";
  EXPECT_GT(pixels_that_differ_after(), 2000);
  for (const Band& band : kBands) {
    EXPECT_GT(share(0.785, 0.045, 0.81, 0.3, [&](const Pixel& p) { return p == band.colour; }), 0.02) << "legend";
  }
}

TEST_F(RenderTest, ThePressureIsInTheColourOfItsBand) {
  draw_with_modulus(60.0);
  const size_t soft = expect_band_of_pressure();
  draw_with_modulus(3000.0);
  const size_t stiff = expect_band_of_pressure();
  EXPECT_LT(soft, stiff) << "under a stiffer skin the pressure should lie in a higher band";
}

/// A face that was scanned green is drawn green, before and after, and its result has the colours.
TEST_F(RenderTest, AFaceHasTheColoursItWasScannedIn) {
  const std::filesystem::path examples(LIPOFILL_EXAMPLES);
  std::ifstream face(examples / "faces" / "half_face.obj");
  std::string coloured;
  for (std::string line; std::getline(face, line);) {
    coloured += line + (line.starts_with("v ") ? " 0.2 0.7 0.3\n" : "\n");
  }
  write("green.obj", coloured);
  auto plan = nlohmann::json::parse(std::ifstream(examples / "plans" / "jaw_angle.json"));
  plan["scan"]["file"] = "green.obj";
  plan["scan"]["landmarks_file"] = (examples / "faces" / "half_face.landmarks.json").string();
  write("green.json", plan.dump());
  const CommandResult made = run("lipofill run green.json --fast --out out --spawn --discard --quiet");
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  EXPECT_THAT(read("out/scan_0000.vtp"), HasSubstr("Name=\"colour\""));
  read_sheet("out/picture.png");
  const auto is_green = [](const Pixel& p) { return p[1] > p[0] + 40 && p[1] > p[2] + 30; };
  EXPECT_GT(share(0.0, 0.5, 0.385, 0.9, is_green), 0.15) << "before";
  EXPECT_GT(share(0.385, 0.5, 0.77, 0.9, is_green), 0.15) << "after";
  EXPECT_LT(share(0.0, 0.045, 0.385, 0.46, is_green), 0.02) << "displacement";
}

TEST_F(RenderTest, ASimulationIsDrawnByItsName) {
  const CommandResult refused = run("lipofill render simulations/none --server 127.0.0.1:1");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("--out FILE.png is needed"));
  const CommandResult away = run("lipofill render simulations/none --out a.png --server 127.0.0.1:1");
  EXPECT_EQ(away.exit_code, 3) << away.errors;
  EXPECT_THAT(run("lipofill render --help").output, HasSubstr("bands of mmHg"));
}

}  // namespace
}  // namespace lipofill::testing
