#pragma once

#include "lipofill/v1/operation_service.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// The operation as the wire has it, with its place in the queue of long work while it waits.
v1::Operation to_operation(const Backend& backend, const OperationView& view);

}  // namespace lipofill::server
