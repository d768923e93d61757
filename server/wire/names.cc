#include "server/wire/names.h"

#include <algorithm>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/field_violations.h"
#include "server/sessions/identifiers.h"
#include "server/store/scope.h"

namespace lipofill::server {
namespace {

constexpr size_t kMaxId = 63;
constexpr int kMaxPage = 1000;

bool is_id_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
}

/// A value as a message may echo it: short and printable.
std::string quoted(const std::string& text) {
  return absl::StrCat("\"", absl::CHexEscape(text.substr(0, 100)), text.size() > 100 ? "...\"" : "\"");
}

/// The ids of a name whose form is given by its collections, for example {"patients", "scans"}.
absl::StatusOr<std::vector<std::string>> parse_name(const std::vector<std::string>& collections,
                                                    const std::string& name, const std::string& field) {
  const std::vector<std::string> parts = absl::StrSplit(name, '/');
  bool good = parts.size() == 2 * collections.size();
  std::vector<std::string> ids;
  for (size_t i = 0; good && i < collections.size(); ++i) {
    good = parts[2 * i] == collections[i] && is_id(parts[2 * i + 1]);
    ids.push_back(parts[2 * i + 1]);
  }
  if (good) return ids;
  std::string form;
  for (const std::string& collection : collections) {
    absl::StrAppend(&form, form.empty() ? "" : "/", collection, "/{", collection.substr(0, collection.size() - 1), "}");
  }
  return field_violation(field, absl::StrCat("is ", quoted(name), ", must be of the form ", form));
}

absl::StatusOr<std::string> parse_single(const char* collection, const std::string& name, const std::string& field) {
  const auto ids = parse_name({collection}, name, field);
  if (!ids.ok()) return ids.status();
  return ids->front();
}

absl::StatusOr<PatientChild> parse_child(const char* collection, const std::string& name, const std::string& field) {
  const auto ids = parse_name({"patients", collection}, name, field);
  if (!ids.ok()) return ids.status();
  return PatientChild{(*ids)[0], (*ids)[1]};
}

}  // namespace

bool is_id(const std::string& text) {
  return !text.empty() && text.size() <= kMaxId && text[0] >= 'a' && text[0] <= 'z' &&
         std::all_of(text.begin(), text.end(), is_id_character);
}

absl::StatusOr<std::string> parse_patient_name(const std::string& name, const std::string& field) {
  return parse_single("patients", name, field);
}
absl::StatusOr<PatientChild> parse_scan_name(const std::string& name, const std::string& field) {
  return parse_child("scans", name, field);
}
absl::StatusOr<PatientChild> parse_model_name(const std::string& name, const std::string& field) {
  return parse_child("models", name, field);
}
absl::StatusOr<PatientChild> parse_plan_name(const std::string& name, const std::string& field) {
  return parse_child("plans", name, field);
}
absl::StatusOr<std::string> parse_simulation_name(const std::string& name, const std::string& field) {
  return parse_single("simulations", name, field);
}
absl::StatusOr<CheckpointParts> parse_checkpoint_name(const std::string& name, const std::string& field) {
  const auto ids = parse_name({"simulations", "checkpoints"}, name, field);
  if (!ids.ok()) return ids.status();
  return CheckpointParts{(*ids)[0], (*ids)[1]};
}
absl::StatusOr<std::string> parse_operation_name(const std::string& name, const std::string& field) {
  return parse_single("operations", name, field);
}

absl::StatusOr<std::string> id_or_new(const std::string& id, char prefix, const std::string& field) {
  if (id.empty()) return make_id(prefix);
  if (is_id(id)) return id;
  return field_violation(field, absl::StrCat("is ", quoted(id), ", must match [a-z][a-z0-9-]{0,62}"));
}

absl::StatusOr<std::string> id_or_new(const std::string& id, char prefix, const std::string& field,
                                      const std::string& tenant) {
  if (!id.empty() && tenant != kLocalTenant && !absl::StartsWith(id, tenant + "-")) {
    return field_violation(field, absl::StrCat("is ", quoted(id), ", must begin with \"", tenant,
                                               "-\", the name of the caller's tenant, or be empty"));
  }
  return id_or_new(id, prefix, field);
}

absl::Status check_display_name(const std::string& text, const std::string& field) {
  if (text.size() <= kMaxId && std::all_of(text.begin(), text.end(), is_id_character)) return absl::OkStatus();
  return field_violation(field, absl::StrCat("is ", quoted(text), " (", text.size(),
                                             " bytes), must be at most 63 characters of [a-z0-9-]"));
}

absl::Status check_request_id(const std::string& request_id) {
  const auto printable = [](char c) { return c > ' ' && c <= '~'; };
  if (request_id.size() <= 64 && std::all_of(request_id.begin(), request_id.end(), printable)) return absl::OkStatus();
  return field_violation("request_id", absl::StrCat("is ", quoted(request_id), " (", request_id.size(),
                                                    " bytes), must be at most 64 printable ASCII characters"));
}

absl::StatusOr<PageRequest> parse_page(const std::string& collection, int page_size, const std::string& page_token) {
  if (page_size < 0) return field_violation("page_size", absl::StrCat("is ", page_size, ", must be in [0, 1000]"));
  PageRequest page;
  if (page_size > 0) page.size = std::min(page_size, kMaxPage);
  if (page_token.empty()) return page;
  std::string plain;
  const std::string start = absl::StrCat(collection, "\n");
  if (!absl::WebSafeBase64Unescape(page_token, &plain) || plain.compare(0, start.size(), start) != 0) {
    return field_violation(
        "page_token", absl::StrCat("is ", quoted(page_token), ", which no list of ", collection, " has given out"));
  }
  page.after = plain.substr(start.size());
  return page;
}

std::string make_page_token(const std::string& collection, const std::string& last_id) {
  return absl::WebSafeBase64Escape(absl::StrCat(collection, "\n", last_id));
}

}  // namespace lipofill::server
