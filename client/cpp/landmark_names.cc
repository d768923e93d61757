#include "client/cpp/landmark_names.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace lipofill::client {
namespace {

struct KnownLandmark {
  const char* name;
  bool is_paired;
  std::array<std::string_view, 5> aliases;
};

constexpr std::array<KnownLandmark, 11> kKnown = {{
    {"nasion", false, {"nasion", "n", "na"}},
    {"pronasale", false, {"pronasale", "prn", "pn", "nosetip"}},
    {"subnasale", false, {"subnasale", "sn"}},
    {"pogonion", false, {"pogonion", "pg", "pog"}},
    {"menton", false, {"menton", "me"}},
    {"exocanthion", true, {"exocanthion", "ex", "exo", "exc", "exocanthus"}},
    {"cheilion", true, {"cheilion", "ch", "chelion"}},
    {"gonion", true, {"gonion", "go"}},
    {"zygion", true, {"zygion", "zy", "zyg"}},
    {"tragion", true, {"tragion", "t", "tr", "tra", "tragus"}},
    {"alare", true, {"alare", "al"}},
}};

/// Words that say nothing about which landmark it is.
constexpr std::array<std::string_view, 4> kFillers = {"soft", "tissue", "landmark", "lm"};
constexpr std::array<std::string_view, 3> kLeftWords = {"left", "l", "lt"};
constexpr std::array<std::string_view, 3> kRightWords = {"right", "r", "rt"};

enum class Side { kNone, kLeft, kRight };

bool is_among(const auto& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

Side side_of(std::string_view word) {
  if (is_among(kLeftWords, word)) return Side::kLeft;
  return is_among(kRightWords, word) ? Side::kRight : Side::kNone;
}

const KnownLandmark* find_known(std::string_view word) {
  const auto* const found = std::find_if(kKnown.begin(), kKnown.end(), [word](const KnownLandmark& known) {
    return !word.empty() && is_among(known.aliases, word);
  });
  return found == kKnown.end() ? nullptr : found;
}

/// Words in lower case: runs of letters and digits, with a new one where a capital follows a small
/// letter.
std::vector<std::string> split_words(std::string_view name) {
  std::vector<std::string> words;
  bool goes_on = false;
  char before = ' ';
  for (const char c : name) {
    const bool is_apart =
        absl::ascii_isupper(static_cast<unsigned char>(c)) && absl::ascii_islower(static_cast<unsigned char>(before));
    if (absl::ascii_isalnum(static_cast<unsigned char>(c))) {
      if (!goes_on || is_apart) words.emplace_back();
      words.back() += absl::ascii_tolower(static_cast<unsigned char>(c));
      goes_on = true;
    } else if (c != '\'') {  // n' is the nasion of the soft tissue
      goes_on = false;
    }
    before = c;
  }
  std::erase_if(words, [](const std::string& word) { return is_among(kFillers, word); });
  return words;
}

/// Takes a side off the front or the back of one word: "gor", "lgo", "gonionleft".
Side take_glued_side(std::string& word) {
  for (const auto& [sides, side] : {std::pair(kLeftWords, Side::kLeft), std::pair(kRightWords, Side::kRight)}) {
    for (const std::string_view text : sides) {
      if (word.size() <= text.size()) continue;
      const std::string without_end = word.substr(0, word.size() - text.size());
      const std::string without_start = word.substr(text.size());
      if (word.ends_with(text) && find_known(without_end) != nullptr) {
        word = without_end;
        return side;
      }
      if (word.starts_with(text) && find_known(without_start) != nullptr) {
        word = without_start;
        return side;
      }
    }
  }
  return Side::kNone;
}

}  // namespace

std::optional<std::string> understand_landmark_name(std::string_view name) {
  std::vector<std::string> words = split_words(name);
  Side side = Side::kNone;
  if (words.size() > 1) {
    const auto word = std::find_if(words.begin(), words.end(), [](const auto& w) { return side_of(w) != Side::kNone; });
    if (word != words.end()) {
      side = side_of(*word);
      words.erase(word);
    }
  }
  std::string rest = absl::StrJoin(words, "");
  if (side == Side::kNone && find_known(rest) == nullptr) side = take_glued_side(rest);
  const KnownLandmark* known = find_known(rest);
  if (known == nullptr || known->is_paired != (side != Side::kNone)) return std::nullopt;
  if (!known->is_paired) return known->name;
  return absl::StrCat(known->name, side == Side::kLeft ? "_left" : "_right");
}

}  // namespace lipofill::client
