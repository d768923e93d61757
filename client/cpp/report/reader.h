#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/substitute.h"
#include "client/cpp/report/document.h"
#include "client/cpp/report/language.h"

namespace lipofill::client {

/// This says how a figure is shown.
struct Shown {
  int decimals = 2;
  double scale = 1.0;
  const char* unit = "";
};

inline constexpr double kPascalPerMmhgShown = 133.322;
inline constexpr Shown kMillilitres = {2, 1.0, "mL"};
inline constexpr Shown kMillimetres = {2, 1.0, "mm"};
inline constexpr Shown kKilopascals = {2, 1e-3, "kPa"};
inline constexpr Shown kMmhg = {1, 1.0 / kPascalPerMmhgShown, "mmHg"};
inline constexpr Shown kPercent = {0, 100.0, "%"};
inline constexpr Shown kCount = {0, 1.0, ""};

/// Reads the record of a report, and says what is there in a language.
class RecordReader {
 public:
  RecordReader(const nlohmann::ordered_json& record, Language language) : record_(record), language_(language) {}

  Language language() const { return language_; }

  /// Finds what a JSON pointer leads to; null where that is nothing.
  const nlohmann::ordered_json& at(const std::string& field) const;
  bool has(const std::string& field) const { return !at(field).is_null(); }
  size_t size(const std::string& field) const { return at(field).size(); }
  /// Empty where there is none.
  std::string text(const std::string& field) const;
  /// Not a number where there is none.
  double number(const std::string& field) const;
  std::vector<std::string> texts(const std::string& field) const;

  template <typename... Values>
  std::string say(const Text& text, const Values&... values) const {
    const std::string_view words = text.in(language_);
    return absl::Substitute(absl::string_view(words.data(), words.size()), values...);
  }

  /// A figure with its unit, or without where the column has it; a dash where there is none.
  Piece figure(const std::string& field, const Shown& shown) const;
  Piece figure_and_unit(const std::string& field, const Shown& shown) const;
  /// A cell of one figure.
  Cell cell(const std::string& field, const Shown& shown) const { return {{figure(field, shown)}}; }
  /// "1.41 (0.67 to 2.15)"
  Cell cell_with_interval(const std::string& field, const std::string& low, const std::string& high,
                          const Shown& shown) const;
  /// A cell of words.
  Cell words(std::string text) const { return {{{std::move(text)}}}; }
  /// A cell of words that the daemon has in English.
  Cell english(std::string text) const;
  /// Tells whose language an English text stands in: empty where it is that of the document.
  std::string language_of_english() const { return language_ == Language::kEnglish ? "" : "en"; }

  /// A zone, a region or a layer, as people call it.
  std::string name(const std::string& id) const;
  /// "below the skin"
  std::string plane(const std::string& layer) const;
  /// Months without decimals that say nothing.
  std::string months(double months) const;

 private:
  const nlohmann::ordered_json& record_;
  Language language_;
};

}  // namespace lipofill::client
