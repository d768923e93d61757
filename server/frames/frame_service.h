#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "lipofill/v1/frame_service.grpc.pb.h"
#include "server/backend/backend.h"
#include "server/backend/kept_result.h"
#include "server/frames/watch_stream.h"
#include "server/sessions/viewer_registry.h"

namespace lipofill::server {

/// Meshes and fields, streamed. The raw callback method lets all viewers share one serialised
/// slice. See proto/lipofill/v1/frame_service.proto.
class FrameService : public v1::FrameService::WithRawCallbackMethod_Watch<
                         v1::FrameService::WithCallbackMethod_AcknowledgeFrame<v1::FrameService::Service>> {
 public:
  explicit FrameService(Backend& backend) : backend_(backend), kept_(backend.store) {}

  grpc::ServerWriteReactor<grpc::ByteBuffer>* Watch(grpc::CallbackServerContext* context,
                                                    const grpc::ByteBuffer* request) override;
  grpc::ServerUnaryReactor* AcknowledgeFrame(grpc::CallbackServerContext* context,
                                             const v1::AcknowledgeFrameRequest* request,
                                             v1::AcknowledgeFrameResponse* response) override;

 private:
  absl::Status begin(grpc::CallbackServerContext* context, const grpc::ByteBuffer& bytes,
                     std::shared_ptr<WatchStream>& stream);
  absl::Status watch_session(const v1::WatchRequest& request, const std::shared_ptr<Session>& session,
                             const std::shared_ptr<WatchStream>& stream);
  /// Wakes the simulation and then watches it.
  absl::Status watch_parked(const v1::WatchRequest& request, const std::string& id,
                            const std::shared_ptr<WatchStream>& stream);
  absl::Status watch_kept(const v1::WatchRequest& request, const std::string& id,
                          const std::shared_ptr<WatchStream>& stream);

  /// Takes a place among the bounded number of streams, held while the stream is open; nullptr when
  /// there is none left.
  std::shared_ptr<void> take_place();

  Backend& backend_;
  std::atomic<int> open_streams_ = 0;
  ViewerRegistry viewers_;
  KeptResults kept_;
};

}  // namespace lipofill::server
