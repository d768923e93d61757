#include "client/cpp/report/command_again.h"

#include <algorithm>
#include <cstddef>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace lipofill::client {
namespace {

constexpr char kPlain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-/=#,:+";

/// Counts how many words, from this one on, only say where the first report was made.
size_t words_to_leave_out(const std::string& word) {
  for (const char* flag : {"report", "--json", "--quiet", "--keep", "--spawn"}) {
    if (word == flag) return 1;
  }
  for (const char* option : {"--out", "--date", "--server", "--token-file", "--tls-ca", "--tls-cert", "--tls-key"}) {
    if (word == option) return 2;
    if (absl::StartsWith(word, absl::StrCat(option, "="))) return 1;
  }
  return 0;
}

/// A word as a shell takes it, a file by its name alone.
std::string word_again(std::string word) {
  const size_t begin = absl::StartsWith(word, "--") ? word.find('=') + 1 : 0;
  const size_t slash = word.rfind('/');
  const bool is_file = slash != std::string::npos && word.compare(begin, 9, "patients/") != 0;
  if (is_file) word.erase(begin, slash + 1 - begin);
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::string command_again(const std::vector<std::string>& words, const std::string& date) {
  std::vector<std::string> again = {"lipofill", "report"};
  bool has_patient = false;
  for (size_t k = 0; k < words.size();) {
    const size_t left_out = words_to_leave_out(words[k]);
    if (left_out == 0) {
      has_patient = has_patient || absl::StartsWith(words[k], "--patient");
      again.push_back(word_again(words[k]));
    }
    k += std::max<size_t>(left_out, 1);
  }
  again.insert(again.end(), {"--date", date, "--out", "report"});
  // What lies with a patient lies on one daemon; everything else can be made anywhere.
  if (!has_patient) again.emplace_back("--spawn");
  return absl::StrJoin(again, " ");
}

}  // namespace lipofill::client
