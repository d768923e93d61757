#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/field_violations.h"

namespace lipofill::server {

/// One setting of the daemon: its name (as in the file, after "--", and with LIPOFILLD_ in the
/// environment), what it may be, and where it goes.
struct Setting {
  using Target = std::variant<std::string*, int*, uint64_t*, double*, bool*, std::vector<std::string>*>;

  std::string name;        ///< "max-simulations"
  std::string value_name;  ///< "N"; of a switch: empty
  std::string help;
  Target target;
  double low = -std::numeric_limits<double>::infinity();  ///< bounds a number from below
  double high = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices = {};  ///< a text is one of these; empty: it may be any

  std::string environment_name() const;  ///< "LIPOFILLD_MAX_SIMULATIONS"
  std::string text() const;              ///< its value now, as a file would have it
  bool is_switch() const { return std::holds_alternative<bool*>(target); }
  bool is_list() const { return std::holds_alternative<std::vector<std::string>*>(target); }
};

/// The value given for a setting, and its source: "--workers", "LIPOFILLD_WORKERS",
/// "lipofilld.toml".
struct GivenValue {
  std::vector<std::string> texts;
  std::string source;
};
using GivenValues = std::map<std::string, GivenValue>;

/// The values in a file of TOML or INI lines, `max-simulations = 8`; also `max_simulations`.
/// INVALID_ARGUMENT for a file that cannot be read and, as field violations, for names that are no
/// setting.
absl::StatusOr<GivenValues> read_settings_file(const std::string& path, const std::vector<Setting>& settings);

/// The values in the environment; of lists, separated by commas. Other variables with the prefix
/// are nobody's mistake: container platforms set some.
GivenValues read_settings_environment(const std::vector<Setting>& settings);

/// Puts what was given in place, and notes what is not a value of its setting: the setting, the
/// text, where it came from and the bound. Checked by tests/unit/server/ops/settings_test.cc.
void assign_settings(const std::vector<Setting>& settings, const GivenValues& given, FieldViolations& violations);

}  // namespace lipofill::server
