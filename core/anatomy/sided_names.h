#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace lipofill::anatomy {

/// Splits "masseter_left" into its stem "masseter" and its side "left"; nothing for a name without
/// a side.
inline std::optional<std::pair<std::string_view, std::string_view>> split_side(std::string_view name) {
  for (const std::string_view side : {"left", "right"}) {
    if (!name.ends_with(side) || name.size() <= side.size()) continue;
    const size_t stem = name.size() - side.size() - 1;
    if (name[stem] == '_') return std::pair(name.substr(0, stem), side);
  }
  return std::nullopt;
}

/// The name of a landmark on a side; those of the midline have none.
inline std::string with_side(std::string_view landmark, std::string_view side) {
  std::string name(landmark);
  if (landmark == "pogonion" || landmark == "menton" || landmark == "nasion" || landmark == "pronasale" ||
      landmark == "subnasale") {
    return name;
  }
  name += '_';
  name += side;
  return name;
}

}  // namespace lipofill::anatomy
