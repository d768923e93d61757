#include "client/cpp/report/reader.h"

#include <cmath>
#include <limits>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "client/cpp/report/catalogue.h"

namespace lipofill::client {

using nlohmann::ordered_json;

const ordered_json& RecordReader::at(const std::string& field) const {
  static const ordered_json nothing;
  const ordered_json::json_pointer pointer(field);
  return record_.contains(pointer) ? record_.at(pointer) : nothing;
}

std::string RecordReader::text(const std::string& field) const {
  const ordered_json& value = at(field);
  return value.is_string() ? value.get<std::string>() : "";
}

double RecordReader::number(const std::string& field) const {
  const ordered_json& value = at(field);
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string> RecordReader::texts(const std::string& field) const {
  std::vector<std::string> texts;
  for (size_t k = 0; k < size(field); ++k) texts.push_back(text(absl::StrCat(field, "/", k)));
  return texts;
}

Piece RecordReader::figure(const std::string& field, const Shown& shown) const {
  const double value = number(field);
  if (!std::isfinite(value)) return {"\u2013"};
  return {number_text(value * shown.scale, shown.decimals, language_), Figure{field, value, shown.scale, shown.unit}};
}

Piece RecordReader::figure_and_unit(const std::string& field, const Shown& shown) const {
  Piece piece = figure(field, shown);
  if (piece.figure) absl::StrAppend(&piece.text, "\u00a0", shown.unit);
  return piece;
}

Cell RecordReader::cell_with_interval(const std::string& field, const std::string& low, const std::string& high,
                                      const Shown& shown) const {
  Cell cell{{figure(field, shown)}};
  if (!has(low) || !has(high)) return cell;
  cell.pieces.insert(cell.pieces.end(), {{" ("}, figure(low, shown), {say(texts::kTo)}, figure(high, shown), {")"}});
  return cell;
}

Cell RecordReader::english(std::string text) const {
  Cell cell = words(std::move(text));
  cell.language = language_of_english();
  return cell;
}

std::string RecordReader::name(const std::string& id) const {
  for (const auto& [suffix, side] : {std::pair("_left", &texts::kLeftOf), std::pair("_right", &texts::kRightOf)}) {
    if (absl::EndsWith(id, suffix)) return say(*side, name(std::string(absl::StripSuffix(id, suffix))));
  }
  for (const texts::Name& known : texts::kNames) {
    if (known.id == id) return say(known.text);
  }
  return absl::StrReplaceAll(id, {{"_", " "}});
}

std::string RecordReader::plane(const std::string& layer) const {
  return layer.empty() ? say(texts::kNoPlane) : say(texts::kBelow, name(layer));
}

std::string RecordReader::months(double months) const {
  return number_text(months, months == std::floor(months) ? 0 : 1, language_);
}

}  // namespace lipofill::client
