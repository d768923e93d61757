// The face from five sides, and the maps on it.

#include "absl/strings/str_cat.h"
#include "client/cpp/report/catalogue.h"
#include "client/cpp/report/sections.h"

namespace lipofill::client {
namespace {

constexpr std::array<const Text*, 5> kViewTexts = {&texts::kRightProfile, &texts::kRightOblique, &texts::kFront,
                                                   &texts::kLeftOblique, &texts::kLeftProfile};

struct Column {
  const char* name;
  std::string heading;
};

std::vector<Column> columns_of(const RecordReader& reader) {
  std::vector<Column> columns = {{"before", reader.say(texts::kBefore)},
                                 {"planned", reader.say(texts::kPlanned)},
                                 {"remaining", reader.say(texts::kRemaining, last_time_text(reader))}};
  if (reader.has("/target")) columns.push_back({"target", reader.say(texts::kTargetColumn)});
  return columns;
}

Map make_map(const RecordReader& reader, const ReportPictures& pictures, const char* name, std::string caption) {
  Map map;
  map.picture = {pictures.png.at(name), reader.say(texts::kMapAlternative, caption)};
  map.caption = std::move(caption);
  return map;
}

Map make_distance_map(const RecordReader& reader, const ReportPictures& pictures, const char* name,
                      std::string caption) {
  Map map = make_map(reader, pictures, name, std::move(caption));
  map.scale = ColourScale{reader.say(texts::kDistanceScale), "mm", -pictures.largest_distance_mm,
                          pictures.largest_distance_mm,      1,    pictures.distance_colours};
  return map;
}

}  // namespace

Section make_views_section(const RecordReader& reader, const ReportPictures& pictures) {
  Section section{"views", reader.say(texts::kViews), {}, true};
  if (!pictures.problem.empty()) {
    section.begins_page = false;
    section.blocks.push_back(paragraph(reader.say(texts::kNoPictures, pictures.problem)));
    return section;
  }
  PictureTable table{"views-table", reader.say(texts::kViewsCaption), {reader.say(texts::kView)}, {}};
  const std::vector<Column> columns = columns_of(reader);
  for (const Column& column : columns) table.columns.push_back(column.heading);
  for (size_t v = 0; v < kViewNames.size(); ++v) {
    const std::string view = reader.say(*kViewTexts[v]);
    std::vector<ReportPicture> row;
    for (const Column& column : columns) {
      row.push_back({pictures.png.at(absl::StrCat(column.name, "-", kViewNames[v])),
                     reader.say(texts::kViewAlternative, column.heading, view)});
    }
    table.rows.emplace_back(view, std::move(row));
  }
  section.blocks.push_back(std::move(table));
  section.blocks.push_back(paragraph(reader.say(texts::kRemainingShape, last_time_text(reader),
                                                reader.figure_and_unit("/remaining/share", kPercent).text)));
  return section;
}

Section make_maps_section(const RecordReader& reader, const ReportPictures& pictures) {
  Section section{"maps", reader.say(texts::kMaps), {}, true};
  if (!pictures.problem.empty()) {
    section.begins_page = false;
    section.blocks.push_back(paragraph(reader.say(texts::kNoPictures, pictures.problem)));
    return section;
  }
  Maps maps;
  if (pictures.png.contains("deficit-map")) {
    maps.maps.push_back(make_distance_map(reader, pictures, "deficit-map", reader.say(texts::kDeficitMap)));
  }
  Map displacement = make_map(reader, pictures, "displacement-map", reader.say(texts::kDisplacementMap));
  displacement.scale = ColourScale{reader.say(texts::kDisplacementScale), "mm", 0.0,
                                   pictures.largest_displacement_mm,      1,    pictures.displacement_colours};
  maps.maps.push_back(std::move(displacement));
  if (pictures.png.contains("planned-distance-map")) {
    maps.maps.push_back(
        make_distance_map(reader, pictures, "planned-distance-map", reader.say(texts::kPlannedDistanceMap)));
    maps.maps.push_back(make_distance_map(reader, pictures, "remaining-distance-map",
                                          reader.say(texts::kRemainingDistanceMap, last_time_text(reader))));
  }
  Map pressure = make_map(reader, pictures, "pressure-map", reader.say(texts::kPressureMap));
  for (size_t band = 0; band < pictures.band_colours.size(); ++band) {
    pressure.legend.emplace_back(pictures.band_colours[band], band_text(reader, band));
  }
  maps.maps.push_back(std::move(pressure));
  const bool has_distances = maps.maps.size() > 2;
  section.blocks.push_back(std::move(maps));
  if (has_distances) {
    section.blocks.push_back(
        paragraph(reader.say(texts::kLinesOfDistance, number_text(pictures.distance_line_mm, 1, reader.language()))));
  }
  return section;
}

}  // namespace lipofill::client
