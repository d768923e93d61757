#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lipofill/v1/simulation.pb.h"

namespace lipofill::client {

/// All fields of a message under their names in the schema, in its order: what the schema gains is
/// here by itself. Numbers are JSON numbers, 64-bit ones too, and names of enumerators strings; a
/// field or message that is absent where it may be is null. Checked by
/// tests/unit/client/message_figures_test.cc.
nlohmann::ordered_json figures_of(const google::protobuf::Message& message);

/// A column of a table with a line a row of the series.
struct SeriesColumn {
  std::string name;                                              ///< with its unit
  std::vector<const google::protobuf::FieldDescriptor*> path{};  ///< from SeriesRow to the figure
  int probe = -1;                                                ///< which one of a figure that every probe has
};

/// Columns for all figures of a row, in the order of the schema: those of messages in it under
/// their own names, "probe_thickness_mm" as "probe_NAME_thickness_mm" for every probe, all figures
/// of one probe side by side.
std::vector<SeriesColumn> columns_of_series(const v1::SimulationSpec& spec);

/// The figure of a column as text: the shortest that reads back to the same value; empty for a
/// probe that the row has not.
std::string value_text(const v1::SeriesRow& row, const SeriesColumn& column);

}  // namespace lipofill::client
