#pragma once

#include <grpcpp/support/server_callback.h>

#include "lipofill/v1/simulation_service.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// Answers FindShape: has the shape found by the drag that the caller names (ShapeDesk), and sends
/// its figures, then its fields.
grpc::ServerWriteReactor<v1::FindShapeResponse>* find_shape(Backend& backend, grpc::CallbackServerContext* context,
                                                            const v1::FindShapeRequest& request);

}  // namespace lipofill::server
