#pragma once

#include <chrono>
#include <string>

namespace lipofill::client {

/// One line on the error output about how far the work is: rewritten in place on a terminal, else a
/// new line every two seconds. Silent when quiet.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine() { finish(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const std::string& text);
  /// Shows the text in any case and goes to the next line.
  void finish(const std::string& text);
  void finish();
  /// A line of its own, for a remark.
  void note(const std::string& text);

 private:
  const bool quiet_;
  const bool terminal_;
  bool open_ = false;  // the cursor stands behind a text
  std::chrono::steady_clock::time_point last_shown_{};
};

}  // namespace lipofill::client
