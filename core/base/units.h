#pragma once

// Factors between SI and the units of messages, files and sentences, under one name each: kAsPerB
// is how many A make a B, so that a value in B times kAsPerB is in A, and one in A divided by it in
// B. To divide by kAsPerB and to multiply by kBsPerA differ in the last bit: a place that does one
// goes on doing it.

#include <numbers>

namespace lipofill {

inline constexpr double kMetresPerMillimetre = 1e-3;
inline constexpr double kMillimetresPerMetre = 1e3;
inline constexpr double kMetresPerCentimetre = 1e-2;
inline constexpr double kCubicMetresPerMillilitre = 1e-6;
inline constexpr double kMillilitresPerCubicMetre = 1e6;
inline constexpr double kSquareCentimetresPerSquareMetre = 1e4;
inline constexpr double kSecondsPerMillisecond = 1e-3;
inline constexpr double kMillisecondsPerSecond = 1e3;
inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

inline constexpr double kPascalsPerKilopascal = 1e3;
inline constexpr double kMegapascalsPerPascal = 1e-6;
inline constexpr double kMillijoulesPerJoule = 1e3;
/// Stiffness of a wall per area: Pa/m in a kPa/mm.
inline constexpr double kPascalsPerMetrePerKilopascalPerMillimetre = 1e6;
/// Stiffness of a spring: N/m in a N/mm, and N/mm in a N/m.
inline constexpr double kNewtonsPerMetrePerNewtonPerMillimetre = 1e3;
inline constexpr double kNewtonsPerMillimetrePerNewtonPerMetre = 1e-3;
/// Density: t/mm3 in a kg/m3.
inline constexpr double kTonnesPerCubicMillimetrePerKilogramPerCubicMetre = 1e-12;
/// Leakage of a wall: m2/(Pa s) in a mL/(s kPa cm).
inline constexpr double kLeakageUnit = 1e-6 / (1e3 * 1e-2);

}  // namespace lipofill
