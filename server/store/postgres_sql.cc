#include "server/store/postgres_sql.h"

#include <algorithm>
#include <array>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"

namespace lipofill::server {
namespace {

constexpr absl::string_view kWithoutRowid = " WITHOUT ROWID";
constexpr std::array<std::pair<absl::string_view, absl::string_view>, 3> kTypes = {
    {{"BLOB", "BYTEA"}, {"INTEGER", "BIGINT"}, {"REAL", "DOUBLE PRECISION"}}};

bool is_of_word(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_';
}

/// Reads statements from their beginning to their end, a piece at a time.
class Translation {
 public:
  explicit Translation(absl::string_view sql) : rest_(sql) {}

  std::string run() {
    while (!rest_.empty()) take_piece();
    return std::move(done_);
  }

 private:
  void take_piece() {
    if (rest_[0] == '\'') return take_quoted();
    if (absl::StartsWith(rest_, "x'")) return take_bytes();
    if (rest_[0] == '?') return take_parameter();
    if (absl::ConsumePrefix(&rest_, kWithoutRowid)) return;
    if (is_of_word(rest_[0])) return take_word();
    done_ += rest_[0];
    rest_.remove_prefix(1);
  }

  /// The quote that ends what begins with one; a doubled quote ends one text and begins another.
  void take_quoted() { move(std::min(rest_.find('\'', 1), rest_.size() - 1) + 1); }

  void take_bytes() {
    const size_t end = std::min(rest_.find('\'', 2), rest_.size());
    absl::StrAppend(&done_, "'\\x", rest_.substr(2, end - 2), "'::bytea");
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
  }

  void take_parameter() {
    rest_.remove_prefix(1);
    const size_t digits = length_of([](char c) { return absl::ascii_isdigit(static_cast<unsigned char>(c)); });
    done_ += '$';
    if (digits == 0) absl::StrAppend(&done_, ++n_parameters_);
    move(digits);
  }

  void take_word() {
    const size_t length = length_of(is_of_word);
    const absl::string_view word = rest_.substr(0, length);
    const auto type =
        std::find_if(kTypes.begin(), kTypes.end(), [word](const auto& pair) { return pair.first == word; });
    if (type == kTypes.end()) return move(length);
    absl::StrAppend(&done_, type->second);
    rest_.remove_prefix(length);
  }

  template <typename Belongs>
  size_t length_of(Belongs belongs) const {
    return static_cast<size_t>(std::find_if_not(rest_.begin(), rest_.end(), belongs) - rest_.begin());
  }

  /// Takes characters as they are.
  void move(size_t count) {
    absl::StrAppend(&done_, rest_.substr(0, count));
    rest_.remove_prefix(count);
  }

  absl::string_view rest_;
  std::string done_;
  int n_parameters_ = 0;
};

}  // namespace

std::string to_postgres(absl::string_view sql) {
  return Translation(sql).run();
}

}  // namespace lipofill::server
