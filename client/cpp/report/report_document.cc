#include "client/cpp/report/report_document.h"

#include "client/cpp/report/catalogue.h"
#include "client/cpp/report/sections.h"

namespace lipofill::client {

std::string time_text(const RecordReader& reader, double months) {
  if (months == 0.0) return reader.say(texts::kAtOnce);
  return months == 1.0 ? reader.say(texts::kAfterOneMonth) : reader.say(texts::kAfterMonths, reader.months(months));
}

std::string last_time_text(const RecordReader& reader) {
  return time_text(reader, reader.number("/remaining/month"));
}

size_t band_of(double pressure_pa) {
  const double mmhg = pressure_pa / kPascalPerMmhgShown;
  return mmhg < 9.0 ? 0 : mmhg < 15.0 ? 1 : mmhg < 30.0 ? 2 : 3;
}

std::string band_text(const RecordReader& reader, size_t band) {
  const std::array<const Text*, 4> words = {&texts::kBand9, &texts::kBand15, &texts::kBand30, &texts::kBandAbove};
  return reader.say(*words[band]);
}

Paragraph paragraph(std::string text, std::string language) {
  return {{{std::move(text)}}, std::move(language)};
}

ReportDocument make_report_document(const RecordReader& reader, const ReportPictures& pictures, Paper paper) {
  ReportDocument document;
  document.language = reader.language();
  document.paper = paper;
  document.title = reader.say(texts::kTitle);
  document.notice = reader.say(texts::kNotice);
  const std::string pseudonym = reader.text("/pseudonym");
  document.running_head = reader.say(texts::kRunningHead, pseudonym.empty() ? reader.say(texts::kNotNamed) : pseudonym,
                                     reader.text("/date"));
  document.page_of = std::string(texts::kPageOf.in(reader.language()));
  document.sections = {make_about_section(reader),           make_glance_section(reader, pictures),
                       make_views_section(reader, pictures), make_maps_section(reader, pictures),
                       make_volumes_section(reader),         make_pressure_section(reader, pictures),
                       make_target_section(reader),          make_delivery_section(reader),
                       make_forecast_section(reader),        make_tissue_section(reader),
                       make_remarks_section(reader),         make_origin_section(reader)};
  return document;
}

}  // namespace lipofill::client
