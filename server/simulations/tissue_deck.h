#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "lipofill/v1/simulation_service.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// Streams the deck of a simulation's tissue as it is now or, from the store, as it was when it
/// ended. Pieces are made as the client takes them. Checked by
/// tests/integration/service/tissue_deck_test.cc.
grpc::ServerWriteReactor<v1::ExportTissueDeckResponse>* export_tissue_deck(Backend& backend,
                                                                           grpc::CallbackServerContext* context,
                                                                           const v1::ExportTissueDeckRequest& request);

}  // namespace lipofill::server
