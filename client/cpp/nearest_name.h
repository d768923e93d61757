#pragma once

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace lipofill::client {

/// Levenshtein distance.
inline size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substituted});
    }
  }
  return row.back();
}

/// Returns the name that someone who wrote `word` may have meant; empty when none is near. Checked
/// by tests/unit/client/plan_file_test.cc and tests/integration/cli/bad_input_test.cc.
inline std::string find_nearest_name(std::string_view word, const std::vector<std::string>& names) {
  std::string nearest;
  size_t nearest_distance = std::max<size_t>(word.size() / 2, 2);
  for (const std::string& name : names) {
    const bool begins_alike = word.size() >= 3 && (name.starts_with(word) || word.starts_with(name));
    const size_t distance = begins_alike ? 0 : edit_distance(word, name);
    if (distance <= nearest_distance) {
      nearest = name;
      nearest_distance = distance;
    }
  }
  return nearest;
}

}  // namespace lipofill::client
