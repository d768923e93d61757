#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <mutex>
#include <set>
#include <string>

#include "lipofill/v1/patient_service.pb.h"
#include "server/backend/backend.h"
#include "server/security/principal.h"

namespace lipofill::server {

v1::Scan to_scan(const ScanRecord& record);

/// Takes in the bytes of scans. A scan's chunks arrive in order, over as many calls, connections
/// and runs of the daemon as it takes; with the last one the whole is checked against its SHA-256
/// and read as a surface. What fails there is removed, record and bytes. Checked by
/// tests/integration/service/upload_test.cc.
class ScanUploads {
 public:
  explicit ScanUploads(Backend& backend) : backend_(backend) {}

  absl::StatusOr<v1::Scan> create(const Principal& caller, const v1::CreateScanRequest& request);
  /// The record with the number of bytes that are really here: after a crash the file may hold
  /// fewer than were noted.
  absl::StatusOr<ScanRecord> find(const std::string& patient, const std::string& scan);
  /// Adds a chunk. INVALID_ARGUMENT for a wrong offset (naming the right one), too many bytes, a
  /// scan that is complete.
  absl::StatusOr<ScanRecord> receive(const std::string& patient, const std::string& scan, uint64_t offset,
                                     const std::string& data);
  /// Completes a scan once all bytes are here; may take seconds. INVALID_ARGUMENT for bytes that
  /// are not those announced or no surface.
  absl::StatusOr<ScanRecord> complete(const std::string& patient, const std::string& scan);

  grpc::ServerReadReactor<v1::UploadScanRequest>* upload(grpc::CallbackServerContext* context, v1::Scan* response);

 private:
  absl::StatusOr<ScanRecord> check_whole(const ScanRecord& record);

  Backend& backend_;
  std::mutex mutex_;
  std::set<std::string> completing_;
};

}  // namespace lipofill::server
