#pragma once

#include <grpcpp/support/server_callback.h>

#include "lipofill/v1/patient_service.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// The meshes of a model at rest: "skin" (quadrilaterals), "tissue" (hexahedra, not yet split by
/// any film) and, where it has one, "scan".
grpc::ServerWriteReactor<v1::MeshSlice>* download_model_mesh(Backend& backend, grpc::CallbackServerContext* context,
                                                             const v1::DownloadModelMeshRequest& request);

/// The surface of a complete scan: "scan".
grpc::ServerWriteReactor<v1::MeshSlice>* download_scan_mesh(Backend& backend, grpc::CallbackServerContext* context,
                                                            const v1::DownloadScanMeshRequest& request);

}  // namespace lipofill::server
