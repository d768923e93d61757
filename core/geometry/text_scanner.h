#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace lipofill::geometry {

/// Walks the lines of a text without copying it, counting from 1. Ends of line may be LF or CR LF.
class LineScanner {
 public:
  explicit LineScanner(std::string_view text) : rest_(text) {}

  /// Reads the next line; false at the end of the text.
  bool next(std::string_view& line);
  size_t line_number() const { return line_number_; }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  size_t line_number_ = 0;
};

/// Takes the next word (anything between blanks) off the front of `line`; empty at its end.
std::string_view take_word(std::string_view& line);

/// A decimal number that fills the whole word; none when it does not or is not finite.
std::optional<double> parse_number(std::string_view word);
std::optional<long long> parse_integer(std::string_view word);

/// A word fit for an error message: shortened, with bytes that do not print replaced.
std::string quote(std::string_view word);

}  // namespace lipofill::geometry
