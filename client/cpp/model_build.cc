#include "client/cpp/model_build.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cpp/errors.h"
#include "lipofill/v1/operation_service.grpc.pb.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

constexpr int kWaitSeconds = 5;

void cancel_operation(const Connection& connection, const std::string& name) {
  v1::CancelOperationRequest request;
  request.set_name(name);
  // The caller leaves either way; a daemon that is gone has nothing to cancel.
  (void)connection.without_stop().call<v1::OperationService>(&v1::OperationService::Stub::CancelOperation, request,
                                                             std::chrono::seconds(5));
}

}  // namespace

absl::StatusOr<v1::Operation> wait_operation(const Connection& connection, v1::Operation operation,
                                             const BuildProgress& progress) {
  if (progress) progress(operation.stage(), operation.progress());
  while (!operation.done()) {
    v1::WaitOperationRequest request;
    request.set_name(operation.name());
    request.mutable_timeout()->set_seconds(kWaitSeconds);
    request.set_seen_progress(operation.progress());
    auto waited = connection.call<v1::OperationService>(&v1::OperationService::Stub::WaitOperation, request);
    if (!waited.ok()) return waited.status();
    operation = *std::move(waited);
    if (progress) progress(operation.stage(), operation.progress());
  }
  if (operation.has_error()) return status_of(operation.error());
  return operation;
}

absl::Status finish_operation(const Connection& connection, const v1::Operation& operation,
                              const BuildProgress& progress, google::protobuf::Message* response) {
  const auto done = wait_operation(connection, operation, progress);
  if (!done.ok()) {
    if (connection.stop().stop_requested()) cancel_operation(connection, operation.name());
    return done.status();
  }
  if (done->response().UnpackTo(response)) return absl::OkStatus();
  return absl::InternalError(
      absl::StrCat("operation ", done->name(), " ended without a ", response->GetDescriptor()->name()));
}

absl::StatusOr<v1::Model> build_model(const Connection& connection, const v1::BuildModelRequest& request,
                                      const BuildProgress& progress) {
  const auto operation = connection.call<v1::PatientService>(&v1::PatientService::Stub::BuildModel, request);
  if (!operation.ok()) return operation.status();
  v1::Model model;
  const absl::Status done = finish_operation(connection, *operation, progress, &model);
  if (!done.ok()) return done;
  return model;
}

}  // namespace lipofill::client
