#pragma once

#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "server/store/scope.h"

/// A condition: `id` is among the patients_of() a scope, which is bound to `patients`; always true
/// where what is bound to `all` is.
#define IS_AMONG(id, all, patients) \
  "(CAST(" all " AS BIGINT) = 1 OR instr(" patients ", CAST(x'2c' || " id " || x'2c' AS BLOB)) > 0)"

namespace lipofill::server {

/// The patients of a scope, each between commas, which no id has.
inline std::string patients_of(const Scope& scope) {
  if (!scope.patients || scope.patients->empty()) return "";
  return absl::StrCat(",", absl::StrJoin(*scope.patients, ","), ",");
}

}  // namespace lipofill::server
