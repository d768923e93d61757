#include "server/ops/settings.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"

namespace lipofill::server {
namespace {

std::string quoted(const std::string& text) {
  return absl::StrCat("\"", text, "\"");
}

std::string given_text(const GivenValue& given) {
  return absl::StrCat("is ", quoted(absl::StrJoin(given.texts, ", ")), " (from ", given.source, "), must be ");
}

std::string range_text(const Setting& setting, const char* kind) {
  return absl::StrCat(kind, " in [", setting.low, ", ", setting.high, "]");
}

/// Assigns one text to one place; an empty answer is good, otherwise it says what the text must be.
struct Assign {
  const Setting& setting;
  const std::vector<std::string>& texts;

  bool single() const { return texts.size() == 1; }
  bool within(double value) const { return value >= setting.low && value <= setting.high; }

  template <typename Integer>
  std::string take_integer(Integer* place) const {
    Integer value = 0;
    const bool read = single() && absl::SimpleAtoi(texts[0], &value);
    if (!read || !within(static_cast<double>(value))) return range_text(setting, "an integer");
    *place = value;
    return "";
  }
  std::string operator()(int* place) const { return take_integer(place); }
  std::string operator()(uint64_t* place) const { return take_integer(place); }
  std::string operator()(double* place) const {
    double value = 0.0;
    if (!single() || !absl::SimpleAtod(texts[0], &value) || !within(value)) return range_text(setting, "a number");
    *place = value;
    return "";
  }
  std::string operator()(bool* place) const {
    if (!single() || !absl::SimpleAtob(texts[0], place)) return "true or false";
    return "";
  }
  std::string operator()(std::string* place) const {
    if (!single()) return "one text";
    const auto& choices = setting.choices;
    if (!choices.empty() && std::find(choices.begin(), choices.end(), texts[0]) == choices.end()) {
      return absl::StrCat("one of ", absl::StrJoin(choices, ", "));
    }
    *place = texts[0];
    return "";
  }
  std::string operator()(std::vector<std::string>* place) const {
    if (texts.empty() || std::find(texts.begin(), texts.end(), "") != texts.end()) return "a list of texts";
    *place = texts;
    return "";
  }
};

struct Text {
  std::string operator()(const int* value) const { return absl::StrCat(*value); }
  std::string operator()(const uint64_t* value) const { return absl::StrCat(*value); }
  std::string operator()(const double* value) const { return absl::StrCat(*value); }
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const std::string* value) const { return quoted(*value); }
  std::string operator()(const std::vector<std::string>* values) const {
    std::vector<std::string> all;
    for (const std::string& value : *values) all.push_back(quoted(value));
    return absl::StrCat("[", absl::StrJoin(all, ", "), "]");
  }
};

bool has_setting(const std::vector<Setting>& settings, const std::string& name) {
  return std::any_of(settings.begin(), settings.end(), [&](const Setting& setting) { return setting.name == name; });
}

absl::StatusOr<std::vector<CLI::ConfigItem>> parse_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) return field_violation("config", absl::StrCat("is ", quoted(path), ", which cannot be read"));
  try {
    return CLI::ConfigTOML().from_config(file);
  } catch (const std::exception& error) {
    return field_violation("config", absl::StrCat("is ", quoted(path), ": ", error.what()));
  }
}

}  // namespace

std::string Setting::environment_name() const {
  return absl::StrCat("LIPOFILLD_", absl::AsciiStrToUpper(absl::StrReplaceAll(name, {{"-", "_"}})));
}

std::string Setting::text() const {
  return std::visit(Text(), target);
}

absl::StatusOr<GivenValues> read_settings_file(const std::string& path, const std::vector<Setting>& settings) {
  const auto items = parse_file(path);
  if (!items.ok()) return items.status();
  GivenValues given;
  FieldViolations violations;
  for (const CLI::ConfigItem& item : *items) {
    const std::string name = absl::StrReplaceAll(item.fullname(), {{"_", "-"}});
    if (!has_setting(settings, name)) {
      violations.add(item.fullname(), absl::StrCat("in ", path, " is no setting"));
    } else if (!given.try_emplace(name, GivenValue{item.inputs, path}).second) {
      violations.add(name, absl::StrCat("is in ", path, " twice"));
    }
  }
  if (!violations.empty()) return violations.to_status();
  return given;
}

GivenValues read_settings_environment(const std::vector<Setting>& settings) {
  GivenValues given;
  for (const Setting& setting : settings) {
    const std::string variable = setting.environment_name();
    const char* value = std::getenv(variable.c_str());
    if (value == nullptr) continue;
    if (setting.is_list()) {
      given[setting.name] = {absl::StrSplit(value, ','), variable};
    } else {
      given[setting.name] = {{value}, variable};
    }
  }
  return given;
}

void assign_settings(const std::vector<Setting>& settings, const GivenValues& given, FieldViolations& violations) {
  for (const Setting& setting : settings) {
    const auto found = given.find(setting.name);
    if (found == given.end()) continue;
    const std::string must_be = std::visit(Assign{setting, found->second.texts}, setting.target);
    if (!must_be.empty()) violations.add(setting.name, given_text(found->second) + must_be);
  }
}

}  // namespace lipofill::server
