#pragma once

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <array>
#include <string>

#include "client/cpp/records/finished_plan.h"
#include "client/cpp/records/record_study.h"
#include "temporary_folder.h"
#include "test_dicom.h"

namespace lipofill::client {

/// A study with the CT of test_dicom.h, and a result with a slab of fat in it.
class RecordsTest : public TemporaryFolderTest {
 protected:
  static constexpr char kFrame[] = "1.2.826.0.1.3680043.9.9999.7";

  void SetUp() override {
    TemporaryFolderTest::SetUp();
    series_.edit = [](DcmDataset* data_set, int) {
      TestSeries::put_text(data_set, DCM_FrameOfReferenceUID, kFrame);
      TestSeries::put_text(data_set, DCM_PatientBirthDate, "19700102");
      TestSeries::put_text(data_set, DCM_StudyDate, "20240304");
    };
    series_.write(folder_ / "ct");
    write_result(folder_ / "result", "SETTLED");
  }

  /// A quadrilateral of `x0` to `x1` and `y0` to `y1` at the height z, turned about the x axis
  /// through its middle by `slope` (mm of z a mm of y).
  static vtkSmartPointer<vtkPolyData> slab(double x0, double x1, double y0, double y1, double z, double thickness,
                                           double slope = 0.0) {
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    const double half = 0.5 * (y1 - y0) * slope;
    for (const auto& [x, y, dz] : {std::array{x0, y0, -half}, {x1, y0, -half}, {x1, y1, half}, {x0, y1, half}})
      points->InsertNextPoint(x, y, z + dz);
    vtkNew<vtkCellArray> cells;
    cells->InsertNextCell({0, 1, 2, 3});
    vtkNew<vtkFloatArray> heights;
    heights->SetName("thickness_mm");
    heights->InsertNextValue(static_cast<float>(thickness));
    surface->SetPoints(points);
    surface->SetPolys(cells);
    surface->GetCellData()->AddArray(heights);
    return surface;
  }

  void write_result(const std::filesystem::path& result, const std::string& state) const {
    std::filesystem::create_directories(result);
    const auto film = slab(15.5, 25.5, 24.125, 34.125, 30.25, 3);
    for (const char* const name : {"scan_0000.vtp", "film_0000.vtp"}) {
      vtkNew<vtkXMLPolyDataWriter> writer;
      writer->SetFileName((result / name).c_str());
      writer->SetInputData(film);
      ASSERT_EQ(writer->Write(), 1);
    }
    std::ofstream(result / "summary.json") << R"({"plan": "cheek", "state": ")" << state << R"(", "injected_ml": 0.3,
      "skin_max_displacement_mm": 2.5, "max_pressure_pa": 812.5, "mean_pressure_pa": null,
      "remarks": ["the tissue is distorted"],
      "zones": [{"name": "malar", "volume_ml": 0.3, "mean_pressure_pa": 700.0, "max_thickness_mm": 3.0}]})";
  }

  RecordStudy study() const {
    auto read = read_record_study(folder_ / "ct", "");
    EXPECT_TRUE(read.ok()) << read.status();
    return *std::move(read);
  }
  FinishedPlan plan() const {
    auto read = read_finished_plan(folder_ / "result");
    EXPECT_TRUE(read.ok()) << read.status();
    return *std::move(read);
  }

  TestSeries series_;
};

}  // namespace lipofill::client
