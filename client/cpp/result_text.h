#pragma once

#include <string>
#include <vector>

#include "lipofill/v1/simulation.pb.h"

namespace lipofill::client {

inline constexpr char kNotAMedicalDevice[] = "Research and planning aid, not a medical device.";

/// Makes summary.json: "plan", "state", "reason", and all figures of the state reached under their
/// names in lipofill.v1.Summary, which other tools rely on. A figure that is absent or not finite
/// is null. Checked by tests/unit/client/result_text_test.cc.
std::string summary_json(const std::string& plan, const v1::Simulation& simulation);

/// The same figures for people.
std::string summary_text(const std::string& plan, const v1::Simulation& simulation);

/// Makes series.csv: a header with units in the names, then a line a step, with all figures of
/// lipofill.v1.SeriesRow in its order. Numbers are the shortest that read back to the same value.
std::string series_csv(const v1::SimulationSpec& spec, const std::vector<v1::SeriesRow>& rows);

/// The outcome of a preview, in a line.
std::string preview_text(const v1::PreviewSummary& preview);

/// Tells in one line where a simulation is.
std::string progress_text(const v1::SeriesRow& row);

/// Name of a state: SETTLED, FAILED, ...
std::string state_name(v1::Simulation::State state);

}  // namespace lipofill::client
