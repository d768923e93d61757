#pragma once

#include <vtkColorTransferFunction.h>
#include <vtkSmartPointer.h>

#include <array>

namespace lipofill::client {

using Colour = std::array<double, 3>;

inline constexpr Colour kSkin = {0.87, 0.70, 0.60};
inline constexpr Colour kInk = {0.12, 0.12, 0.14};
/// Colour of a surface where there is nothing to show.
inline constexpr Colour kNothing = {0.93, 0.91, 0.89};

/// A range of settled pressure and what it is called. The bounds are assumed: the first is the
/// critical interstitial pressure.
struct PressureBand {
  double below_mmhg;  ///< infinite for the last
  const char* label;
  Colour colour;
};

/// Bands of pressure from harmless to harmful. Lightness falls from band to band, so that they are
/// told apart without colour too.
extern const std::array<PressureBand, 4> kPressureBands;

inline constexpr double kPascalPerMmhg = 133.322;

const PressureBand& pressure_band_of(double pressure_pa);

/// Colours of movement: white where nothing moved, then through yellow and red to dark. Lightness
/// falls all the way, so it also reads without colour.
vtkSmartPointer<vtkColorTransferFunction> displacement_colours(double largest);

/// Colours of distance: blue inside the target, white on it, red outside; skin where there is no
/// value.
vtkSmartPointer<vtkColorTransferFunction> distance_colours(double largest);

}  // namespace lipofill::client
