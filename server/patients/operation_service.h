#pragma once

#include "lipofill/v1/operation_service.grpc.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// Long-running operations. See proto/lipofill/v1/operation_service.proto.
class OperationService : public v1::OperationService::CallbackService {
 public:
  explicit OperationService(Backend& backend) : backend_(backend) {}

  using Context = grpc::CallbackServerContext;
  using Reactor = grpc::ServerUnaryReactor;

  Reactor* GetOperation(Context* context, const v1::GetOperationRequest* request, v1::Operation* response) override;
  Reactor* ListOperations(Context* context, const v1::ListOperationsRequest* request,
                          v1::ListOperationsResponse* response) override;
  Reactor* WaitOperation(Context* context, const v1::WaitOperationRequest* request, v1::Operation* response) override;
  Reactor* CancelOperation(Context* context, const v1::CancelOperationRequest* request,
                           google::protobuf::Empty* response) override;

 private:
  Backend& backend_;
};

}  // namespace lipofill::server
