#pragma once

#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "lipofill/v1/frame_service.grpc.pb.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {

/// A watch service whose streams break where a test wants them to: the real daemon's do so too
/// rarely to test with.
class BreakingFrameService : public v1::FrameService::Service {
 public:
  /// Serves one stream: what it is asked, and how to answer. The last one serves all further
  /// streams.
  using Stream = std::function<grpc::Status(const v1::WatchRequest&, grpc::ServerWriter<v1::WatchResponse>*)>;
  std::vector<Stream> streams;
  std::vector<v1::WatchRequest> requests;
  std::vector<v1::AcknowledgeFrameRequest> acknowledged;
  grpc::Status acknowledgement;
  std::function<void()> on_acknowledge;

  grpc::Status AcknowledgeFrame(grpc::ServerContext*, const v1::AcknowledgeFrameRequest* request,
                                v1::AcknowledgeFrameResponse*) override {
    acknowledged.push_back(*request);
    if (on_acknowledge) on_acknowledge();
    return acknowledgement;
  }
  grpc::Status Watch(grpc::ServerContext*, const v1::WatchRequest* request,
                     grpc::ServerWriter<v1::WatchResponse>* writer) override {
    requests.push_back(*request);
    return streams.at(std::min(requests.size(), streams.size()) - 1)(*request, writer);
  }
};

/// Takes scans, and drops the first upload after some bytes.
class BreakingPatientService : public v1::PatientService::Service {
 public:
  v1::Scan scan;
  std::string received;
  std::vector<uint64_t> chunk_sizes;
  size_t drop_after_bytes = 0;

  grpc::Status CreateScan(grpc::ServerContext*, const v1::CreateScanRequest* request, v1::Scan* response) override {
    scan.set_name(absl::StrCat(request->parent(), "/scans/s"));
    scan.set_size_bytes(request->size_bytes());
    scan.set_sha256(request->sha256());
    *response = scan;
    return grpc::Status::OK;
  }
  grpc::Status GetScan(grpc::ServerContext*, const v1::GetScanRequest*, v1::Scan* response) override {
    scan.set_received_bytes(received.size());
    *response = scan;
    return grpc::Status::OK;
  }
  grpc::Status UploadScan(grpc::ServerContext*, grpc::ServerReader<v1::UploadScanRequest>* reader,
                          v1::Scan* response) override {
    v1::UploadScanRequest chunk;
    while (reader->Read(&chunk)) {
      if (chunk.offset() != received.size()) return {grpc::StatusCode::OUT_OF_RANGE, "offset"};
      received += chunk.data();
      chunk_sizes.push_back(chunk.data().size());
      if (drop_after_bytes > 0 && received.size() >= drop_after_bytes) {
        drop_after_bytes = 0;
        return {grpc::StatusCode::UNAVAILABLE, "dropped"};
      }
    }
    scan.set_received_bytes(received.size());
    scan.set_complete(received.size() == scan.size_bytes());
    *response = scan;
    return grpc::Status::OK;
  }
};

/// A server of some services on a free port.
class LocalServer {
 public:
  explicit LocalServer(grpc::Service* service) {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(service);
    server_ = builder.BuildAndStart();
    address_ = absl::StrCat("127.0.0.1:", port);
  }
  ~LocalServer() { server_->Shutdown(std::chrono::system_clock::now()); }

  const std::string& address() const { return address_; }

 private:
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
};

}  // namespace lipofill::client
