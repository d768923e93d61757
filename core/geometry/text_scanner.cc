#include "core/geometry/text_scanner.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"

namespace lipofill::geometry {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

template <typename Number>
std::optional<Number> parse_whole(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  if (word.empty() || word.front() == '+') return std::nullopt;
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace

size_t LineScanner::find_line_feed() const {
  return std::min(text_.find('\n', offset_), text_.size());
}

bool LineScanner::next(std::string_view& line) {
  if (offset_ >= text_.size()) return false;
  if (line_feed_ < offset_) line_feed_ = find_line_feed();
  line = text_.substr(offset_, line_feed_ - offset_);
  const size_t carriage_return = line.find('\r');
  if (carriage_return == std::string_view::npos) {
    offset_ = std::min(line_feed_ + 1, text_.size());
  } else {
    line = line.substr(0, carriage_return);
    const size_t behind = offset_ + carriage_return + 1;
    offset_ = behind == line_feed_ && behind < text_.size() ? behind + 1 : behind;
  }
  ++line_number_;
  return true;
}

size_t count_line_ends(std::string_view text) {
  size_t count = 0;
  for (size_t k = 0; k < text.size(); ++k) {
    const bool is_before_line_feed = k + 1 < text.size() && text[k + 1] == '\n';
    if (text[k] == '\n' || (text[k] == '\r' && !is_before_line_feed)) ++count;
  }
  return count;
}

bool begins_with_ignoring_case(std::string_view text, std::string_view word) {
  return absl::StartsWithIgnoreCase(absl::string_view(text.data(), text.size()),
                                    absl::string_view(word.data(), word.size()));
}

std::string_view skip_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

std::string_view take_word(std::string_view& line) {
  size_t begin = 0;
  while (begin < line.size() && is_blank(line[begin])) ++begin;
  size_t end = begin;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

std::optional<double> parse_number(std::string_view word) {
  const auto value = parse_whole<double>(word);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<double> parse_number_or_nan(std::string_view word) {
  if (const auto value = parse_whole<double>(word)) return value;
  // This takes what is too large or too small for a double, and the spellings of Microsoft's
  // library.
  if (word.find(".#") != std::string_view::npos) {
    const std::string_view kind = word.substr(word.find(".#") + 2);
    const bool is_known = begins_with_ignoring_case(kind, "qnan") || begins_with_ignoring_case(kind, "snan") ||
                          begins_with_ignoring_case(kind, "ind") || begins_with_ignoring_case(kind, "inf");
    if (is_known) return std::numeric_limits<double>::quiet_NaN();
  }
  double value = 0.0;
  if (!word.empty() && absl::SimpleAtod(absl::string_view(word.data(), word.size()), &value)) return value;
  return std::nullopt;
}

std::optional<long long> parse_integer(std::string_view word) {
  return parse_whole<long long>(word);
}

std::string quote(std::string_view word) {
  constexpr size_t kLongest = 24;
  std::string text = "'";
  for (const char c : word.substr(0, kLongest)) text += c >= ' ' && c <= '~' ? c : '?';
  if (word.size() > kLongest) text += "...";
  return text + "'";
}

}  // namespace lipofill::geometry
