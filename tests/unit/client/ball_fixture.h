#pragma once

#include <gmock/gmock.h>
#include <vtkNew.h>
#include <vtkPLYReader.h>
#include <vtkPolyData.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "client/cpp/volume/skin_extraction.h"
#include "client/cpp/volume/volume_header.h"
#include "temporary_folder.h"
#include "test_volumes.h"

namespace lipofill::client {

/// Extracts the ball of test_volumes.h out of files.
class BallTest : public TemporaryFolderTest {
 protected:
  static SkinExtraction at_500() {
    SkinExtraction options;
    options.isovalue = -500.0;
    return options;
  }

  /// Extracts the ball and compares with the sphere it is: radius and centre everywhere, volume
  /// with its sign.
  void expect_ball(const std::string& name, const std::string& bytes, const std::array<double, 3>& centre) {
    expect_ball_of(name, extract_skin(write(name, bytes), folder_ / "skin.ply", at_500()), centre);
  }

  /// The same of a ball that has been extracted to skin.ply.
  void expect_ball_of(const std::string& name, const absl::StatusOr<ExtractedSkin>& skin,
                      const std::array<double, 3>& centre) {
    ASSERT_TRUE(skin.ok()) << name << ": " << skin.status();
    EXPECT_EQ(skin->components, 1);
    vtkNew<vtkPLYReader> reader;
    reader->SetFileName((folder_ / "skin.ply").c_str());
    reader->Update();
    vtkPolyData* surface = reader->GetOutput();
    ASSERT_GT(surface->GetNumberOfPoints(), 500);
    // Linear interpolation of a distance along an edge of length s errs by s^2 / (8 R) = 0.020 mm;
    // half a HU is 0.002 mm.
    constexpr double kBound = 0.023;
    for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
      const double* p = surface->GetPoint(i);
      EXPECT_NEAR(std::hypot(p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]), BallVolume().radius, kBound)
          << name;
    }
    EXPECT_NEAR(signed_volume(surface) / (4.0 / 3.0 * std::numbers::pi * std::pow(BallVolume().radius, 3)), 1.0, 0.02)
        << name;
  }

  /// Positive when the triangles face outwards.
  static double signed_volume(vtkPolyData* surface) {
    double volume = 0.0;
    for (vtkIdType c = 0; c < surface->GetNumberOfCells(); ++c) {
      vtkIdType n = 0;
      const vtkIdType* ids = nullptr;
      surface->GetCellPoints(c, n, ids);
      std::array<double, 3> a, b, d;
      surface->GetPoint(ids[0], a.data());
      surface->GetPoint(ids[1], b.data());
      surface->GetPoint(ids[2], d.data());
      volume += (a[0] * (b[1] * d[2] - b[2] * d[1]) - a[1] * (b[0] * d[2] - b[2] * d[0]) +
                 a[2] * (b[0] * d[1] - b[1] * d[0])) /
                6.0;
    }
    return volume;
  }

  std::string refusal_of(const std::string& name, const std::string& bytes) {
    const auto header = read_volume_header(write(name, bytes));
    EXPECT_EQ(header.status().code(), absl::StatusCode::kInvalidArgument) << name;
    EXPECT_THAT(std::string(header.status().message()), ::testing::HasSubstr(name));
    return std::string(header.status().message());
  }
};

}  // namespace lipofill::client
