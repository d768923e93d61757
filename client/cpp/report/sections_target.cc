// This section says how near the skin comes to its target, and what it lacks.

#include <algorithm>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "client/cpp/report/catalogue.h"
#include "client/cpp/report/sections.h"

namespace lipofill::client {
namespace {

constexpr size_t kMostRegions = 12;

std::string origin_text(const RecordReader& reader) {
  const std::string side = reader.text("/target/report/mirrored_side");
  if (side.empty()) return reader.say(texts::kSurfaceTarget, reader.text("/target/sha256"));
  return reader.say(texts::kMirroredTarget, reader.say(side == "left" ? texts::kLeftSide : texts::kRightSide));
}

Table distance_table(const RecordReader& reader) {
  Table table{"target-distances",
              reader.say(texts::kDistances),
              {reader.say(texts::kFigure), reader.say(texts::kBefore), reader.say(texts::kPlanned),
               reader.say(texts::kRemaining, last_time_text(reader))},
              {}};
  const auto add = [&](const Text& what, const std::string& before, const std::string& after, const Shown& shown) {
    table.rows.push_back({reader.words(reader.say(what)), reader.cell("/planned/evaluation" + before, shown),
                          reader.cell("/planned/evaluation" + after, shown),
                          reader.cell("/remaining/evaluation" + after, shown)});
  };
  const auto add_part = [&](const Text& what, const std::string& part, const Shown& shown) {
    add(what, "/without_rim_before" + part, "/without_rim" + part, shown);
  };
  add_part(texts::kMissing, "/volume/deficit_ml", kMillilitres);
  add_part(texts::kTooMuch, "/volume/excess_ml", kMillilitres);
  add_part(texts::kRms, "/skin_to_target/rms_mm", kMillimetres);
  add_part(texts::kP95, "/skin_to_target/p95_mm", kMillimetres);
  add_part(texts::kHausdorff, "/hausdorff_mm", kMillimetres);
  add_part(texts::kUnder2, "/skin_to_target/share_under_2_mm", kPercent);
  if (reader.has("/planned/evaluation/symmetry")) {
    add(texts::kSymmetry, "/symmetry/before_mm", "/symmetry/simulated_mm", kMillimetres);
  }
  return table;
}

/// Regions from the one that lacks most on.
std::vector<std::string> find_worst(const RecordReader& reader) {
  std::vector<std::string> regions;
  for (size_t r = 0; r < reader.size("/deficit/regions"); ++r) regions.push_back(absl::StrCat("/deficit/regions/", r));
  std::stable_sort(regions.begin(), regions.end(), [&](const std::string& a, const std::string& b) {
    return reader.number(a + "/volume/deficit_ml") > reader.number(b + "/volume/deficit_ml");
  });
  if (regions.size() > kMostRegions) regions.resize(kMostRegions);
  return regions;
}

Table region_table(const RecordReader& reader) {
  Table table{"target-regions",
              reader.say(texts::kRegions),
              {reader.say(texts::kRegion), reader.say(texts::kMissing), reader.say(texts::kTooMuch),
               reader.say(texts::kDeepest), reader.say(texts::kRms)},
              {}};
  const auto add = [&](std::string name, const std::string& field) {
    table.rows.push_back({reader.words(std::move(name)), reader.cell(field + "/volume/deficit_ml", kMillilitres),
                          reader.cell(field + "/volume/excess_ml", kMillilitres),
                          reader.cell(field + "/max_deficit_mm", kMillimetres),
                          reader.cell(field + "/distance/rms_mm", kMillimetres)});
  };
  for (const std::string& region : find_worst(reader)) add(reader.name(reader.text(region + "/region")), region);
  add(reader.say(texts::kAll), "/deficit/all");
  return table;
}

}  // namespace

Section make_target_section(const RecordReader& reader) {
  Section section{"target", reader.say(texts::kTarget)};
  if (!reader.has("/target")) {
    section.blocks.push_back(paragraph(reader.say(texts::kNoTarget)));
    return section;
  }
  section.blocks.push_back(paragraph(origin_text(reader)));
  section.blocks.push_back(distance_table(reader));
  if (reader.has("/deficit")) {
    section.blocks.push_back(region_table(reader));
    section.blocks.push_back(paragraph(reader.say(texts::kRegionsOverlap)));
  }
  return section;
}

}  // namespace lipofill::client
