#pragma once

#include <string>

#include "client/cpp/report/report_document.h"

namespace lipofill::client {

// Each of these makes one section of the report.
Section make_about_section(const RecordReader& reader);
Section make_glance_section(const RecordReader& reader, const ReportPictures& pictures);
Section make_views_section(const RecordReader& reader, const ReportPictures& pictures);
Section make_maps_section(const RecordReader& reader, const ReportPictures& pictures);
Section make_volumes_section(const RecordReader& reader);
Section make_pressure_section(const RecordReader& reader, const ReportPictures& pictures);
Section make_target_section(const RecordReader& reader);
Section make_delivery_section(const RecordReader& reader);
Section make_forecast_section(const RecordReader& reader);
Section make_tissue_section(const RecordReader& reader);
Section make_remarks_section(const RecordReader& reader);
Section make_origin_section(const RecordReader& reader);

/// "at once" for 0, "after 12 months".
std::string time_text(const RecordReader& reader, double months);

/// "after 12 months": the last month of the retention.
std::string last_time_text(const RecordReader& reader);

/// The band of a settled pressure, from 0, and its words.
size_t band_of(double pressure_pa);
std::string band_text(const RecordReader& reader, size_t band);

/// An uncertain quantity in words: "stiffness of skin, times the model's".
/// @param field  of the input in the record
std::string input_text(const RecordReader& reader, const std::string& field);

Paragraph paragraph(std::string text, std::string language = "");

}  // namespace lipofill::client
