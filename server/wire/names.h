#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::server {

/// Parts of a resource name.
struct PatientChild {
  std::string patient;
  std::string id;
};

struct CheckpointParts {
  std::string simulation;
  std::string id;
};

/// Takes resource names apart. INVALID_ARGUMENT for `field` saying what the name should look like.
/// Checked by tests/unit/server/wire/names_test.cc.
absl::StatusOr<std::string> parse_patient_name(const std::string& name, const std::string& field);
absl::StatusOr<PatientChild> parse_scan_name(const std::string& name, const std::string& field);
absl::StatusOr<PatientChild> parse_model_name(const std::string& name, const std::string& field);
absl::StatusOr<PatientChild> parse_plan_name(const std::string& name, const std::string& field);
absl::StatusOr<std::string> parse_simulation_name(const std::string& name, const std::string& field);
absl::StatusOr<CheckpointParts> parse_checkpoint_name(const std::string& name, const std::string& field);
absl::StatusOr<std::string> parse_operation_name(const std::string& name, const std::string& field);

/// True when a text matches [a-z][a-z0-9-]{0,62}.
bool is_id(const std::string& text);

/// The id given, or a new one when it is empty. INVALID_ARGUMENT unless it matches
/// [a-z][a-z0-9-]{0,62}.
absl::StatusOr<std::string> id_or_new(const std::string& id, char prefix, const std::string& field);
/// The same for ids that tenants share: an id that a tenant chooses begins with the tenant's name
/// and '-', so that nobody learns from a collision what others have. Those of "local" are free.
absl::StatusOr<std::string> id_or_new(const std::string& id, char prefix, const std::string& field,
                                      const std::string& tenant);

/// A name for people: at most 63 characters of [a-z0-9-].
absl::Status check_display_name(const std::string& text, const std::string& field);
/// Checks that a request id is at most 64 printable ASCII characters.
absl::Status check_request_id(const std::string& request_id);

/// The number of resources to list, and after which.
struct PageRequest {
  std::string after;
  int size = 100;
};
/// Reads a page request. INVALID_ARGUMENT for a negative size or a token that was not made for
/// `collection`. More than 1000 are cut to 1000.
absl::StatusOr<PageRequest> parse_page(const std::string& collection, int page_size, const std::string& page_token);
std::string make_page_token(const std::string& collection, const std::string& last_id);

}  // namespace lipofill::server
