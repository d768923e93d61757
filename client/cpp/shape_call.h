#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/arrays.h"
#include "client/cpp/connection.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

/// A settled shape that was found for a call: its figures, and the fields that were asked for.
struct SettledShape {
  v1::FoundShape figures;
  std::vector<Array> fields;
};

/// Has the daemon find the settled shape of a plan with other volumes. ABORTED where a newer call
/// of the same drag took the place of this one. Checked by tests/integration/cli/commands_test.cc.
absl::StatusOr<SettledShape> find_shape(const Connection& connection, const v1::FindShapeRequest& request);

}  // namespace lipofill::client
