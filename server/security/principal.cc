#include "server/security/principal.h"

#include <algorithm>

namespace lipofill::server {
namespace {

constexpr Role kRoles[] = {Role::kViewer, Role::kPlanner, Role::kAdmin};
constexpr size_t kMaxTenant = 31;

}  // namespace

const char* role_name(Role role) {
  switch (role) {
    case Role::kNone:
      return "none";
    case Role::kViewer:
      return "viewer";
    case Role::kPlanner:
      return "planner";
    case Role::kAdmin:
      return "admin";
  }
  return "none";
}

Role role_of(const std::string& word) {
  const auto* found = std::find_if(std::begin(kRoles), std::end(kRoles), [&](Role r) { return word == role_name(r); });
  return found == std::end(kRoles) ? Role::kNone : *found;
}

bool is_tenant(const std::string& text) {
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto fits = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); };
  return !text.empty() && text.size() <= kMaxTenant && is_letter(text[0]) &&
         std::all_of(text.begin(), text.end(), fits);
}

}  // namespace lipofill::server
