#pragma once

#include <string>
#include <variant>
#include <vector>

namespace lipofill::server {

/// Something a line of the log says under a name of its own.
struct LogField {
  std::string name;
  std::variant<std::string, double> value;
};
using LogFields = std::vector<LogField>;

/// Lines to standard error, flushed one by one. "text": time in UTC, level, message, name=value of
/// each field. "json": an object a line with "time", "level", "message" and the fields. Messages
/// name resources by their pseudonymous ids only. Checked by tests/unit/server/ops/logging_test.cc.
void set_up_logging(const std::string& level, const std::string& format);

/// While it lives, the lines of its thread carry its fields, after those of scopes around it.
class LogScope {
 public:
  explicit LogScope(LogFields fields);
  ~LogScope();
  LogScope(const LogScope&) = delete;
  LogScope& operator=(const LogScope&) = delete;

 private:
  const LogFields fields_;
};

}  // namespace lipofill::server
