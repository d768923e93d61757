#pragma once

#include <cstddef>

#include "absl/status/statusor.h"
#include "client/cpp/arrays.h"
#include "lipofill/v1/planning_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

/// The distances of an evaluation as a field over all points of its mesh; not a number outside the
/// region. DATA_LOSS for one that does not fit the mesh.
absl::StatusOr<Array> distance_field(const v1::Evaluation& evaluation, size_t points);

/// The distances of a deficit as a field of the mesh "scan".
Array distance_field(const v1::Deficit& deficit);

}  // namespace lipofill::client
