// These sections say what is known of the result, what causes its spread, and what is left after
// months.

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "client/cpp/report/catalogue.h"
#include "client/cpp/report/sections.h"

namespace lipofill::client {
namespace {

/// Causes of less than this are not told in words, and no more than three are.
constexpr double kLeastShare = 0.05;
constexpr size_t kMostCauses = 3;
/// Where more of the variance than this is unexplained, the daemon tells no influences.
constexpr double kMostUnexplained = 0.1;

std::string time_at(size_t place) {
  return absl::StrCat("/forecast/times/", place);
}

/// A figure of a forecast by its name, with the unit that it is shown in.
std::string figure_text(const RecordReader& reader, const std::string& field) {
  const std::string name = reader.text(field + "/name");
  const std::string zone = reader.name(reader.text(field + "/zone"));
  if (name == "max_lift") return reader.say(texts::kMaxLift);
  if (name == "skin_volume") return reader.say(texts::kSkinVolume);
  if (name == "mean_pressure") return reader.say(texts::kZonePressure, zone);
  if (name == "volume") return reader.say(texts::kZoneVolume, zone);
  return absl::StrCat(reader.name(name), " ", zone);
}

Shown shown_of(const RecordReader& reader, const std::string& field) {
  const std::string unit = reader.text(field + "/unit");
  if (unit == "Pa") return kMmhg;
  return unit == "mm" ? kMillimetres : kMillilitres;
}

Table interval_table(const RecordReader& reader) {
  Table table{"intervals", reader.say(texts::kIntervals), {reader.say(texts::kFigure)}, {}};
  const size_t times = reader.size("/forecast/times");
  for (size_t t = 0; t < times; ++t) {
    table.columns.push_back(time_text(reader, reader.number(time_at(t) + "/month")));
  }
  for (size_t f = 0; f < reader.size("/forecast/times/0/figures"); ++f) {
    const std::string first = absl::StrCat(time_at(0), "/figures/", f);
    std::vector<Cell> row = {reader.words(figure_text(reader, first))};
    for (size_t t = 0; t < times; ++t) {
      const std::string field = absl::StrCat(time_at(t), "/figures/", f);
      row.push_back(reader.cell_with_interval(field + "/p50", field + "/p05", field + "/p95", shown_of(reader, first)));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The two or three inputs that matter most for a figure.
Cell causes_cell(const RecordReader& reader, const std::string& figure) {
  if (reader.number(figure + "/unexplained_share") > kMostUnexplained) {
    return reader.words(
        reader.say(texts::kUnexplained, reader.figure_and_unit(figure + "/unexplained_share", kPercent).text));
  }
  Cell cell;
  for (size_t k = 0; k < std::min(kMostCauses, reader.size(figure + "/influences")); ++k) {
    const std::string influence = absl::StrCat(figure, "/influences/", k);
    if (reader.number(influence + "/total") < kLeastShare) break;
    const auto input = static_cast<size_t>(reader.number(influence + "/input"));
    cell.pieces.push_back(
        {absl::StrCat(k == 0 ? "" : "; ", input_text(reader, absl::StrCat("/forecast/inputs/", input)), ": ")});
    cell.pieces.push_back(reader.figure_and_unit(influence + "/total", kPercent));
    cell.pieces.push_back({" (\u00b1\u00a0"});
    cell.pieces.push_back(reader.figure_and_unit(influence + "/total_error", kPercent));
    cell.pieces.push_back({")"});
  }
  return cell.pieces.empty() ? reader.words(reader.say(texts::kNoSpread)) : cell;
}

Table cause_table(const RecordReader& reader) {
  Table table{"causes",
              reader.say(texts::kCauses),
              {reader.say(texts::kFigure), reader.say(texts::kWhen), reader.say(texts::kCause)},
              {}};
  const size_t last = reader.size("/forecast/times") - 1;
  for (size_t f = 0; f < reader.size("/forecast/times/0/figures"); ++f) {
    for (const size_t t : {size_t{0}, last}) {
      const std::string field = absl::StrCat(time_at(t), "/figures/", f);
      table.rows.push_back({reader.words(figure_text(reader, field)),
                            reader.words(time_text(reader, reader.number(time_at(t) + "/month"))),
                            causes_cell(reader, field)});
    }
  }
  return table;
}

Table retention_table(const RecordReader& reader) {
  Table table{"retention", reader.say(texts::kRetention), {reader.say(texts::kWhen), reader.say(texts::kShare)}, {}};
  for (size_t k = 0; k < reader.size("/retention/months"); ++k) {
    const std::string month = absl::StrCat("/retention/months/", k);
    table.rows.push_back({reader.words(time_text(reader, reader.number(month + "/month"))),
                          reader.cell_with_interval(month + "/p50", month + "/p05", month + "/p95", kPercent)});
  }
  return table;
}

void add_forecast(const RecordReader& reader, Section& section) {
  if (!reader.has("/forecast")) {
    const std::string refusal = reader.text("/no_forecast");
    section.blocks.push_back(
        paragraph(refusal.empty() ? reader.say(texts::kNoForecast) : reader.say(texts::kForecastRefused, refusal)));
    return;
  }
  const auto members = static_cast<int>(reader.number("/forecast/members"));
  const auto failed = static_cast<int>(reader.number("/forecast/failed_members"));
  section.blocks.push_back(paragraph(reader.say(texts::kForecastOf, members - failed, members)));
  section.blocks.push_back(interval_table(reader));
  section.blocks.push_back(cause_table(reader));
}

}  // namespace

Section make_forecast_section(const RecordReader& reader) {
  Section section{"forecast", reader.say(texts::kForecast)};
  add_forecast(reader, section);
  section.blocks.push_back(retention_table(reader));
  section.blocks.push_back(paragraph(reader.text("/retention/source"), reader.language_of_english()));
  if (reader.at("/retention/updated") == true)
    section.blocks.push_back(paragraph(reader.say(texts::kRetentionUpdated)));
  return section;
}

}  // namespace lipofill::client
