#pragma once

#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "server/store/scope.h"

namespace lipofill::server {

/// The patients of a scope as a JSON array, for json_each; ids need no escapes.
inline std::string json_of(const Scope& scope) {
  if (!scope.patients || scope.patients->empty()) return "[]";
  return absl::StrCat("[\"", absl::StrJoin(*scope.patients, "\",\""), "\"]");
}

}  // namespace lipofill::server
