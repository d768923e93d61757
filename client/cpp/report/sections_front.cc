// These sections say what the report is of, and the figures to look at first.

#include <cmath>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/report/catalogue.h"
#include "client/cpp/report/sections.h"

namespace lipofill::client {
namespace {

constexpr double kLargeGridError = 0.05;

std::string scan_text(const RecordReader& reader) {
  if (!reader.has("/scan")) return reader.say(texts::kNoScan);
  return reader.say(texts::kScanIs, reader.figure("/scan/vertices", kCount).text,
                    reader.figure("/scan/triangles", kCount).text, reader.text("/scan/sha256"));
}

/// The preparation, and what the plan says beyond it.
Cell fat_cell(const RecordReader& reader) {
  Cell cell = reader.words(reader.name(reader.text("/plan/fat/preset")));
  for (const auto& [key, unit] : {std::pair("viscosity_pa_s", "Pa s"), std::pair("density_kg_m3", "kg/m\u00b3"),
                                  std::pair("yield_stress_pa", "Pa")}) {
    const std::string field = absl::StrCat("/plan/fat/", key);
    if (!reader.has(field)) continue;
    cell.pieces.push_back({", "});
    cell.pieces.push_back(reader.figure_and_unit(field, {1, 1.0, unit}));
  }
  return cell;
}

/// A way in steps is told by the daemon, in English.
Cell state_cell(const RecordReader& reader) {
  if (reader.text("/planned/state") != "SETTLED") return reader.words(reader.say(texts::kNotSettled));
  const std::string way = reader.text("/planned/summary/way");
  return reader.words(reader.say(texts::kSettled, way == "directly" ? reader.say(texts::kDirectly) : way));
}

/// A forecast compares three grids, a simulation two.
Cell grid_cell(const RecordReader& reader) {
  const bool has_three = reader.has("/forecast/grid_error/lift_share");
  const std::string field = has_three ? "/forecast/grid_error" : "/planned/summary/discretisation_error";
  if (!reader.has(field + "/lift_share")) {
    const std::string reason = reader.text(field + "/reason");
    return reader.words(reader.say(texts::kNoGridError, reason.empty() ? reader.say(texts::kNotSettled) : reason));
  }
  Cell cell{{{reader.say(texts::kGridLift)},
             reader.figure_and_unit(field + "/lift_share", {1, 100.0, "%"}),
             {reader.say(texts::kGridPressure)},
             reader.figure_and_unit(field + "/pressure_share", {1, 100.0, "%"}),
             {reader.say(texts::kGridSkin)},
             reader.figure_and_unit(field + "/skin_mm", {3, 1.0, "mm"}),
             {reader.say(texts::kGridPlaces)}}};
  const double worst = std::fmax(reader.number(field + "/lift_share"), reader.number(field + "/pressure_share"));
  if (worst >= kLargeGridError) cell.pieces.push_back({reader.say(texts::kGridLarge)});
  if (has_three && reader.at(field + "/order_holds") != true) cell.pieces.push_back({reader.say(texts::kGridNoOrder)});
  return cell;
}

/// The zone under the highest mean pressure.
Cell pressure_cell(const RecordReader& reader, const ReportPictures& pictures) {
  std::string highest;
  for (size_t z = 0; z < reader.size("/planned/summary/zones"); ++z) {
    const std::string zone = absl::StrCat("/planned/summary/zones/", z);
    if (highest.empty() || reader.number(zone + "/mean_pressure_pa") > reader.number(highest + "/mean_pressure_pa")) {
      highest = zone;
    }
  }
  if (highest.empty()) return reader.words("\u2013");
  const size_t band = band_of(reader.number(highest + "/mean_pressure_pa"));
  Cell cell{{reader.figure_and_unit(highest + "/mean_pressure_pa", kMmhg),
             {absl::StrCat(", ", band_text(reader, band), ": ", reader.name(reader.text(highest + "/name")))}}};
  cell.mark = pictures.band_colours[band];
  return cell;
}

Cell missing_cell(const RecordReader& reader) {
  const std::string planned = "/planned/evaluation";
  return {{reader.figure(planned + "/without_rim_before/volume/deficit_ml", kMillilitres),
           {absl::StrCat(" ", reader.say(texts::kBeforeThen), ", ")},
           reader.figure(planned + "/without_rim/volume/deficit_ml", kMillilitres),
           {absl::StrCat(" ", reader.say(texts::kPlanned), ", ")},
           reader.figure("/remaining/evaluation/without_rim/volume/deficit_ml", kMillilitres),
           {absl::StrCat(" ", reader.say(texts::kRemaining, last_time_text(reader)))}}};
}

Cell lift_cell(const RecordReader& reader) {
  return {{reader.figure_and_unit("/planned/summary/skin_max_displacement_mm", kMillimetres),
           {absl::StrCat(" ", reader.say(texts::kAtOnce), ", ")},
           reader.figure_and_unit("/remaining/summary/skin_max_displacement_mm", kMillimetres),
           {absl::StrCat(" ", last_time_text(reader))}}};
}

Cell share_cell(const RecordReader& reader) {
  const std::string last = absl::StrCat("/retention/months/", reader.size("/retention/months") - 1);
  return reader.cell_with_interval(last + "/p50", last + "/p05", last + "/p95", kPercent);
}

}  // namespace

Section make_about_section(const RecordReader& reader) {
  const std::string pseudonym = reader.text("/pseudonym");
  const std::string description = reader.text("/plan/description");
  Table table{"facts", reader.say(texts::kAbout), {reader.say(texts::kFact), reader.say(texts::kValue)}, {}};
  const auto add = [&](const Text& fact, Cell value) {
    table.rows.push_back({reader.words(reader.say(fact)), std::move(value)});
  };
  add(texts::kPatient, reader.words(pseudonym.empty() ? reader.say(texts::kNotNamed) : pseudonym));
  add(texts::kDate, reader.words(reader.text("/date")));
  add(texts::kScan, reader.words(scan_text(reader)));
  add(texts::kPlan, reader.words(absl::StrCat(reader.name(reader.text("/plan/name")),
                                              description.empty() ? "" : absl::StrCat(": ", description))));
  add(texts::kFat, fat_cell(reader));
  add(texts::kState, state_cell(reader));
  return {"about", reader.say(texts::kAbout), {std::move(table)}};
}

Section make_glance_section(const RecordReader& reader, const ReportPictures& pictures) {
  const std::string then = last_time_text(reader);
  Table table{"glance", reader.say(texts::kGlanceCaption), {reader.say(texts::kFigure), reader.say(texts::kValue)}, {}};
  const auto add = [&](std::string what, Cell value) {
    table.rows.push_back({reader.words(std::move(what)), std::move(value)});
  };
  add(reader.say(texts::kToPrepare), reader.cell("/volumes/total/prepare_ml", kMillilitres));
  add(reader.say(texts::kToInject), reader.cell("/volumes/total/inject_ml", kMillilitres));
  add(reader.say(texts::kRemains, then), reader.cell("/volumes/total/remaining_ml", kMillilitres));
  add(reader.say(texts::kShareLeft, then) + " [%]", share_cell(reader));
  add(reader.say(texts::kLift), lift_cell(reader));
  add(reader.say(texts::kHighestPressure), pressure_cell(reader, pictures));
  if (reader.has("/planned/evaluation")) add(reader.say(texts::kMissing), missing_cell(reader));
  add(reader.say(texts::kGridError), grid_cell(reader));
  return {"glance", reader.say(texts::kGlance), {std::move(table)}};
}

}  // namespace lipofill::client
