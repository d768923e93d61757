#include "client/cpp/report/language.h"

#include <algorithm>

#include "absl/strings/str_format.h"

namespace lipofill::client {

const LanguageInfo& info_of(Language language) {
  return kLanguages[static_cast<size_t>(language)];
}

std::optional<Language> find_language(std::string_view code) {
  for (const LanguageInfo& info : kLanguages) {
    if (info.code == code) return info.language;
  }
  return std::nullopt;
}

std::string number_text(double value, int decimals, Language language) {
  std::string text = absl::StrFormat("%.*f", decimals, value);
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  const bool is_negative = text.starts_with('-');
  if (is_negative) text.erase(0, 1);
  std::replace(text.begin(), text.end(), '.', info_of(language).decimal_mark);
  return is_negative && !is_zero ? "\u2212" + text : text;
}

}  // namespace lipofill::client
