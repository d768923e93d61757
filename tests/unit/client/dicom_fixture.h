#pragma once

#include <string>

#include "ball_fixture.h"
#include "client/cpp/dicom/dicom_volume.h"
#include "test_dicom.h"

namespace lipofill::client {

/// Reads the ball of test_dicom.h out of DICOM.
class DicomTest : public BallTest {
 protected:
  static constexpr std::array<double, 3> kCentre{25, 28, 31};

  absl::StatusOr<ExtractedSkin> extract(const std::string& name, const DicomReading& options = {}) const {
    auto dicom = read_dicom_volume(folder_ / name, options);
    if (!dicom.ok()) return dicom.status();
    return extract_skin(std::move(dicom->volume), name, folder_ / "skin.ply", at_500());
  }

  void expect_ball_in(const std::string& name, const DicomReading& options = {}) {
    expect_ball_of(name, extract(name, options), kCentre);
  }

  /// What is said of a source that is refused. Nothing of the patient is ever among it.
  std::string dicom_refusal_of(const std::string& name, const DicomReading& options = {}) const {
    const auto dicom = read_dicom_volume(folder_ / name, options);
    EXPECT_FALSE(dicom.ok()) << name;
    const std::string said(dicom.status().message());
    EXPECT_EQ(said.find("SECRET"), std::string::npos) << said;
    EXPECT_EQ(said.find("4711"), std::string::npos) << said;
    return said;
  }
};

}  // namespace lipofill::client
