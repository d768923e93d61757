#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace lipofill::client {

/// Languages of the report. Another one is a line here and in kLanguages, and one more argument of
/// Text, which the compiler then asks for at every text of catalogue.h.
enum class Language { kEnglish, kGerman };

struct LanguageInfo {
  Language language;
  const char* code;  ///< BCP 47, as in <html lang>
  char decimal_mark;
};

inline constexpr std::array<LanguageInfo, 2> kLanguages = {{
    {Language::kEnglish, "en", '.'},
    {Language::kGerman, "de", ','},
}};

const LanguageInfo& info_of(Language language);

/// The language of a code; none for another code.
std::optional<Language> find_language(std::string_view code);

/// A text in every language, with places $0 to $9 for what is filled in. It does not compile where
/// a language lacks the text, or has other places than the first.
class Text {
 public:
  consteval Text(std::string_view english, std::string_view german) : words_{english, german} {
    for (const std::string_view words : words_) {
      if (words.empty()) throw "a language lacks this text";
      if (places_of(words) != places_of(english)) throw "a language fills in something else";
    }
  }

  constexpr std::string_view in(Language language) const { return words_[static_cast<size_t>(language)]; }

 private:
  static consteval unsigned places_of(std::string_view words) {
    unsigned places = 0;
    for (size_t k = 0; k + 1 < words.size(); ++k) {
      if (words[k] == '$') places |= 1U << (words[k + 1] - '0');
    }
    return places;
  }

  std::array<std::string_view, kLanguages.size()> words_;
};

/// A number with so many decimals, as people of the language write it; a minus sign in place of a
/// hyphen. Checked by tests/unit/client/report_document_test.cc.
std::string number_text(double value, int decimals, Language language);

}  // namespace lipofill::client
