#include "client/cpp/picture/colours.h"

#include <limits>

namespace lipofill::client {
const std::array<PressureBand, 4> kPressureBands = {{
    {9.0, "below 9 mmHg (1.2 kPa)", {0.66, 0.85, 0.72}},
    {15.0, "9 to 15 mmHg", {0.96, 0.74, 0.26}},
    {30.0, "15 to 30 mmHg", {0.85, 0.40, 0.10}},
    {std::numeric_limits<double>::infinity(), "above 30 mmHg (4.0 kPa)", {0.52, 0.03, 0.14}},
}};

const PressureBand& pressure_band_of(double pressure_pa) {
  for (const PressureBand& band : kPressureBands) {
    if (pressure_pa < band.below_mmhg * kPascalPerMmhg) return band;
  }
  return kPressureBands.back();
}

vtkSmartPointer<vtkColorTransferFunction> displacement_colours(double largest) {
  auto colours = vtkSmartPointer<vtkColorTransferFunction>::New();
  const double top = largest > 0.0 ? largest : 1.0;
  colours->AddRGBPoint(0.0, kNothing[0], kNothing[1], kNothing[2]);
  colours->AddRGBPoint(0.25 * top, 0.99, 0.84, 0.46);
  colours->AddRGBPoint(0.5 * top, 0.97, 0.55, 0.26);
  colours->AddRGBPoint(0.75 * top, 0.82, 0.20, 0.18);
  colours->AddRGBPoint(top, 0.40, 0.02, 0.22);
  return colours;
}

vtkSmartPointer<vtkColorTransferFunction> distance_colours(double largest) {
  auto colours = vtkSmartPointer<vtkColorTransferFunction>::New();
  const double top = largest > 0.0 ? largest : 1.0;
  colours->AddRGBPoint(-top, 0.10, 0.20, 0.60);
  colours->AddRGBPoint(-0.5 * top, 0.45, 0.65, 0.90);
  colours->AddRGBPoint(0.0, 0.97, 0.97, 0.97);
  colours->AddRGBPoint(0.5 * top, 0.95, 0.60, 0.45);
  colours->AddRGBPoint(top, 0.70, 0.05, 0.10);
  colours->SetNanColor(kSkin[0], kSkin[1], kSkin[2]);
  return colours;
}

}  // namespace lipofill::client
