#pragma once

#include <string>
#include <vector>

#include "core/forecast/forecast.h"
#include "core/forecast/member_run.h"

namespace lipofill::forecast {

/// The figures of a time over the members that settled, its pressure bands and its fields.
/// @param nominal  the shape with every input at its nominal value
ForecastTime summarise_time(const MemberTable& table, size_t time, double month, const std::vector<std::string>& zones,
                            const simulation::MemberShape& nominal, bool fields);

/// Adds what causes the spread of each of a time's figures.
void add_influences(const MemberTable& table, size_t time, const Design& design, const std::vector<std::string>& zones,
                    ForecastTime& to);

/// The inputs that matter most for the figures of a time, a sentence a figure.
std::vector<std::string> describe_causes(const ForecastTime& time, const std::vector<UncertainInput>& inputs);

/// For people: "the pressure in masseter".
std::string describe_figure(const ForecastFigure& figure);

/// Above this, influences say too little of a figure.
inline constexpr double kMostUnexplained = 0.1;

}  // namespace lipofill::forecast
