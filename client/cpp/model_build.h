#pragma once

#include <functional>
#include <string>

#include "absl/status/statusor.h"
#include "client/cpp/connection.h"
#include "lipofill/v1/operation_service.pb.h"
#include "lipofill/v1/patient_service.pb.h"

namespace lipofill::client {

/// Takes the present stage of the operation, and its progress in [0, 1].
using BuildProgress = std::function<void(const std::string&, double)>;

/// Waits for an operation to be done, telling every progress. The operation's own error is the
/// error of the call. CANCELLED, the operation going on, when the connection's stop is asked for.
absl::StatusOr<v1::Operation> wait_operation(const Connection& connection, v1::Operation operation,
                                             const BuildProgress& progress = {});

/// Waits for an operation and takes its response. When the connection's stop is asked for, the
/// operation is cancelled too. INTERNAL where the response is of another type.
absl::Status finish_operation(const Connection& connection, const v1::Operation& operation,
                              const BuildProgress& progress, google::protobuf::Message* response);

/// Builds a model and waits for it. When the connection's stop is asked for, the building is
/// cancelled too.
/// Checked by tests/integration/cli/.
absl::StatusOr<v1::Model> build_model(const Connection& connection, const v1::BuildModelRequest& request,
                                      const BuildProgress& progress = {});

}  // namespace lipofill::client
