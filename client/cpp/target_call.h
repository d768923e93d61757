#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/arrays.h"
#include "client/cpp/connection.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/model_build.h"
#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::client {

/// Makes a target and waits for it. When the connection's stop is asked for, the making is
/// cancelled too. Checked by tests/integration/cli/target_test.cc, as are the others.
absl::StatusOr<v1::Target> make_target(const Connection& connection, const v1::MakeTargetRequest& request,
                                       const BuildProgress& progress = {});

/// Asks what a face lacks to its target. A large scan takes the daemon some ten seconds.
absl::StatusOr<v1::Deficit> measure_deficit(const Connection& connection, const v1::MeasureDeficitRequest& request);

/// The surface of a scan: arrays "scan.points" [mm] and "scan.cells".
absl::StatusOr<std::vector<Array>> download_scan_mesh(const Connection& connection, const std::string& scan);

/// Puts landmarks into a field of a request.
void set_landmarks(const Landmarks& landmarks, google::protobuf::Map<std::string, v1::Vector3>* field);

}  // namespace lipofill::client
