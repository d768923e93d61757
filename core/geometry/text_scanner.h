#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace lipofill::geometry {

/// Walks the lines of a text without copying it, counting from 1. A line ends with LF, CR LF or a
/// CR alone, and the three may stand in one text.
class LineScanner {
 public:
  explicit LineScanner(std::string_view text) : text_(text), line_feed_(find_line_feed()) {}

  /// Reads the next line; false at the end of the text.
  bool next(std::string_view& line);
  size_t line_number() const { return line_number_; }
  std::string_view rest() const { return text_.substr(offset_); }

 private:
  size_t find_line_feed() const;

  std::string_view text_;
  size_t offset_ = 0;
  size_t line_feed_;  ///< the next one at or behind offset_, or the end of the text
  size_t line_number_ = 0;
};

/// Counts how often a line ends in a piece of text.
size_t count_line_ends(std::string_view text);

/// True when the text goes on with `word`, given in lower case, whatever the case in the text.
bool begins_with_ignoring_case(std::string_view text, std::string_view word);

/// The text without the byte order mark of UTF-8 at its beginning.
std::string_view skip_byte_order_mark(std::string_view text);

/// Takes the next word (anything between blanks) off the front of `line`; empty at its end.
std::string_view take_word(std::string_view& line);

/// A decimal number that fills the whole word; none when it does not or is not finite.
std::optional<double> parse_number(std::string_view word);

/// The same for a number that may be spelled as not finite ("nan", "-inf", "1.#QNAN"), or be too
/// large for a double.
std::optional<double> parse_number_or_nan(std::string_view word);
std::optional<long long> parse_integer(std::string_view word);

/// A word fit for an error message: shortened, with bytes that do not print replaced.
std::string quote(std::string_view word);

}  // namespace lipofill::geometry
