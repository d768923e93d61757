// These sections say how much to prepare, to inject and to keep, and the pressure that comes of it.

#include "absl/strings/str_cat.h"
#include "client/cpp/report/catalogue.h"
#include "client/cpp/report/sections.h"

namespace lipofill::client {
namespace {

Table plan_table(const RecordReader& reader) {
  const std::string then = last_time_text(reader);
  Table table{"volumes-plan",
              reader.say(texts::kVolumesOfPlan),
              {reader.say(texts::kZone), reader.say(texts::kPlane), reader.say(texts::kToPrepare),
               reader.say(texts::kToInject), reader.say(texts::kRemains, then)},
              {}};
  for (size_t z = 0; z < reader.size("/volumes/zones"); ++z) {
    const std::string zone = absl::StrCat("/volumes/zones/", z);
    table.rows.push_back({reader.words(reader.name(reader.text(zone + "/zone"))),
                          reader.words(reader.plane(reader.text(zone + "/below_layer"))),
                          reader.cell(zone + "/prepare_ml", kMillilitres),
                          reader.cell(zone + "/inject_ml", kMillilitres),
                          reader.cell_with_interval(zone + "/remaining_ml", zone + "/remaining_p05_ml",
                                                    zone + "/remaining_p95_ml", kMillilitres)});
  }
  table.rows.push_back({reader.words(reader.say(texts::kAll)), reader.words(""),
                        reader.cell("/volumes/total/prepare_ml", kMillilitres),
                        reader.cell("/volumes/total/inject_ml", kMillilitres),
                        reader.cell("/volumes/total/remaining_ml", kMillilitres)});
  return table;
}

Table over_correction_table(const RecordReader& reader) {
  Table table{"volumes-wanted",
              reader.say(texts::kOverCorrection, last_time_text(reader)),
              {reader.say(texts::kZone), reader.say(texts::kWanted), reader.say(texts::kInjectFor),
               reader.say(texts::kMostAtOnce)},
              {}};
  for (size_t z = 0; z < reader.size("/forecast/zones"); ++z) {
    const std::string zone = absl::StrCat("/forecast/zones/", z);
    table.rows.push_back({reader.words(reader.name(reader.text(zone + "/zone"))),
                          reader.cell(zone + "/wanted_ml", kMillilitres),
                          reader.cell_with_interval(zone + "/inject_ml", zone + "/inject_low_ml",
                                                    zone + "/inject_high_ml", kMillilitres),
                          reader.cell(zone + "/most_at_once_ml", kMillilitres)});
  }
  return table;
}

Table sessions_table(const RecordReader& reader) {
  Table table{"sessions",
              reader.say(texts::kSessions),
              {reader.say(texts::kSessionColumn), reader.say(texts::kZone), reader.say(texts::kPlane),
               reader.say(texts::kPresent), reader.say(texts::kToPrepare), reader.say(texts::kToInject)},
              {}};
  for (size_t s = 0; s < reader.size("/volumes/sessions"); ++s) {
    const std::string session = absl::StrCat("/volumes/sessions/", s);
    const std::string name = reader.say(texts::kSession, s + 1, reader.months(reader.number(session + "/month")));
    const auto add = [&](std::string zone, std::string plane, const std::string& field) {
      table.rows.push_back({reader.words(name), reader.words(std::move(zone)), reader.words(std::move(plane)),
                            reader.cell(field + "/present_ml", kMillilitres),
                            reader.cell(field + "/prepare_ml", kMillilitres),
                            reader.cell(field + "/inject_ml", kMillilitres)});
    };
    for (size_t z = 0; z < reader.size(session + "/zones"); ++z) {
      const std::string zone = absl::StrCat(session, "/zones/", z);
      add(reader.name(reader.text(zone + "/zone")), reader.plane(reader.text(zone + "/below_layer")), zone);
    }
    add(reader.say(texts::kAll), "", session + "/total");
  }
  return table;
}

/// Finds where a zone is in a list of the record that has names under `key`.
std::string find_zone(const RecordReader& reader, const std::string& list, const std::string& key,
                      const std::string& name) {
  for (size_t z = 0; z < reader.size(list); ++z) {
    const std::string field = absl::StrCat(list, "/", z);
    if (reader.text(absl::StrCat(field, "/", key)) == name) return field;
  }
  return absl::StrCat(list, "/none");
}

Table pressure_table(const RecordReader& reader, const ReportPictures& pictures) {
  Table table{"pressure-zones",
              reader.say(texts::kPressureCaption),
              {reader.say(texts::kZone), reader.say(texts::kWhen), reader.say(texts::kMeanPressure),
               reader.say(texts::kMeanKilopascals), reader.say(texts::kBand)},
              {}};
  const bool has_bands = reader.has("/forecast");
  for (size_t band = 0; has_bands && band < pictures.band_colours.size(); ++band) {
    table.columns.push_back(reader.say(texts::kProbability, band_text(reader, band)));
  }
  const auto add = [&](const std::string& zone, const std::string& when, const std::string& time) {
    const size_t band = band_of(reader.number(zone + "/mean_pressure_pa"));
    Cell in_words = reader.words(band_text(reader, band));
    in_words.mark = pictures.band_colours[band];
    std::vector<Cell> row = {reader.words(reader.name(reader.text(zone + "/name"))), reader.words(when),
                             reader.cell(zone + "/mean_pressure_pa", kMmhg),
                             reader.cell(zone + "/mean_pressure_pa", kKilopascals), std::move(in_words)};
    const std::string bands = find_zone(reader, time + "/bands", "zone", reader.text(zone + "/name"));
    for (const char* key : {"/below_9_mmhg", "/from_9_to_15_mmhg", "/from_15_to_30_mmhg", "/above_30_mmhg"}) {
      if (has_bands) row.push_back(reader.cell(bands + key, kPercent));
    }
    table.rows.push_back(std::move(row));
  };
  const size_t last = has_bands ? reader.size("/forecast/times") - 1 : 0;
  for (size_t z = 0; z < reader.size("/planned/summary/zones"); ++z) {
    add(absl::StrCat("/planned/summary/zones/", z), reader.say(texts::kAtOnce), "/forecast/times/0");
    add(absl::StrCat("/remaining/summary/zones/", z), last_time_text(reader), absl::StrCat("/forecast/times/", last));
  }
  return table;
}

}  // namespace

Section make_volumes_section(const RecordReader& reader) {
  Section section{"volumes", reader.say(texts::kVolumes), {plan_table(reader)}, true};
  section.blocks.push_back(
      paragraph(reader.say(texts::kReserve, reader.figure_and_unit("/volumes/reserve_share", kPercent).text)));
  if (!reader.has("/forecast")) {
    if (reader.text("/no_forecast").empty()) section.blocks.push_back(paragraph(reader.say(texts::kNoSessionsAsked)));
    return section;
  }
  section.blocks.push_back(over_correction_table(reader));
  if (reader.size("/volumes/sessions") == 0) {
    section.blocks.push_back(paragraph(reader.say(texts::kNoSessions)));
  } else {
    section.blocks.push_back(sessions_table(reader));
  }
  return section;
}

Section make_pressure_section(const RecordReader& reader, const ReportPictures& pictures) {
  Section section{"pressure", reader.say(texts::kPressure), {pressure_table(reader, pictures)}};
  section.blocks.push_back(paragraph(reader.say(texts::kBandsAssumed)));
  if (!reader.has("/forecast") && reader.text("/no_forecast").empty()) {
    section.blocks.push_back(paragraph(reader.say(texts::kNoBands)));
  }
  return section;
}

}  // namespace lipofill::client
