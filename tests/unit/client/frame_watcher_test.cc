#include "client/cpp/frame_watcher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "scripted_service.h"

namespace lipofill::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Writer = grpc::ServerWriter<v1::WatchResponse>;

void send_meshes(Writer* writer) {
  v1::WatchResponse response;
  v1::MeshSlice* mesh = response.mutable_mesh();
  mesh->set_topology_hash("hash");
  v1::ArraySlice* array = mesh->add_arrays();
  array->set_name("skin.points");
  array->set_type(v1::FLOAT32);
  array->set_location(v1::MESH);
  array->add_shape(1);
  array->add_shape(3);
  const float point[] = {1, 2, 3};
  array->set_data(point, 8);
  writer->Write(response);
  array->set_offset_bytes(8);
  array->set_data(point + 2, 4);
  mesh->set_last(true);
  writer->Write(response);
}

void send_frame(Writer* writer, uint64_t sequence, bool end) {
  v1::WatchResponse response;
  v1::FrameSlice* frame = response.mutable_frame();
  frame->set_epoch(9);
  frame->set_sequence(sequence);
  frame->set_time_s(0.01 * static_cast<double>(sequence));
  frame->set_topology_hash("hash");
  frame->set_last(true);
  frame->set_end(end);
  writer->Write(response);
}

class FrameWatcherTest : public ::testing::Test {
 protected:
  WatchHandlers handlers() {
    WatchHandlers result;
    result.on_meshes = [this](const Meshes& meshes) {
      ++meshes_;
      EXPECT_THAT(meshes.arrays.at(0).floats(), ElementsAre(1, 2, 3));
      return absl::OkStatus();
    };
    result.on_frame = [this](const Frame& frame) {
      frames_.push_back(frame.sequence);
      return absl::OkStatus();
    };
    return result;
  }

  BreakingFrameService service_;
  int meshes_ = 0;
  std::vector<uint64_t> frames_;
};

TEST_F(FrameWatcherTest, TakesUpABrokenStreamAfterTheLastFrame) {
  service_.streams = {[](const v1::WatchRequest&, Writer* writer) {
                        send_meshes(writer);
                        send_frame(writer, 1, false);
                        send_frame(writer, 2, false);
                        return grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, "too slow");
                      },
                      [](const v1::WatchRequest&, Writer* writer) {
                        send_frame(writer, 3, true);
                        return grpc::Status::OK;
                      }};
  const LocalServer server(&service_);
  v1::WatchRequest request;
  request.set_delivery(v1::WatchRequest::EVERY);
  const absl::Status status = watch(Connection(server.address()), request, handlers());
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(meshes_, 1);
  EXPECT_THAT(frames_, ElementsAre(1u, 2u, 3u));
  ASSERT_EQ(service_.requests.size(), 2u);
  EXPECT_EQ(service_.requests[1].seen_epoch(), 9u);
  EXPECT_EQ(service_.requests[1].seen_sequence(), 2u);
  EXPECT_EQ(service_.requests[1].known_topology_hash(), "hash");
}

TEST_F(FrameWatcherTest, TellsThePreviewFromASteps) {
  service_.streams = {[](const v1::WatchRequest&, Writer* writer) {
    send_frame(writer, 0, false);
    v1::WatchResponse preview;
    preview.mutable_frame()->set_epoch(9);
    preview.mutable_frame()->set_time_s(40.0);
    preview.mutable_frame()->set_preview(true);
    preview.mutable_frame()->set_last(true);
    writer->Write(preview);
    send_frame(writer, 1, true);
    return grpc::Status::OK;
  }};
  const LocalServer server(&service_);
  std::vector<bool> previews;
  WatchHandlers noting = handlers();
  noting.on_frame = [&previews](const Frame& frame) {
    previews.push_back(frame.preview);
    return absl::OkStatus();
  };
  EXPECT_TRUE(watch(Connection(server.address()), {}, noting).ok());
  EXPECT_THAT(previews, ElementsAre(false, true, false));
}

TEST_F(FrameWatcherTest, AcknowledgesEachFrameOnceItIsTaken) {
  service_.streams = {[](const v1::WatchRequest&, Writer* writer) {
                        send_frame(writer, 3, false);
                        return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
                      },
                      [](const v1::WatchRequest&, Writer* writer) {
                        send_frame(writer, 4, false);
                        send_frame(writer, 5, true);
                        return grpc::Status::OK;
                      }};
  service_.acknowledgement = grpc::Status(grpc::StatusCode::NOT_FOUND, "it has ended");
  const LocalServer server(&service_);
  v1::WatchRequest request;
  request.set_simulation("simulations/a");
  request.set_max_unacknowledged_frames(1);
  EXPECT_TRUE(watch(Connection(server.address()), request, handlers()).ok());
  EXPECT_THAT(frames_, ElementsAre(3, 4, 5));
  ASSERT_EQ(service_.acknowledged.size(), 2u) << "all but the last";
  EXPECT_EQ(service_.acknowledged[0].simulation(), "simulations/a");
  EXPECT_EQ(service_.acknowledged[0].epoch(), 9u);
  EXPECT_EQ(service_.acknowledged[0].sequence(), 3u);
  EXPECT_EQ(service_.acknowledged[1].sequence(), 4u);
  EXPECT_EQ(service_.acknowledged[0].viewer().size(), 17u);
  EXPECT_EQ(service_.requests[1].viewer(), service_.acknowledged[0].viewer()) << "the same takes its place again";
}

TEST_F(FrameWatcherTest, WhoseNameAnotherTookGivesWay) {
  service_.streams = {[](const v1::WatchRequest&, Writer* writer) {
    send_frame(writer, 3, false);
    return grpc::Status(grpc::StatusCode::ABORTED, "another Watch of this viewer took its place");
  }};
  const LocalServer server(&service_);
  EXPECT_TRUE(absl::IsAborted(watch(Connection(server.address()), {}, handlers())));
  EXPECT_EQ(service_.requests.size(), 1u);
}

TEST_F(FrameWatcherTest, ARefusedAcknowledgementIsTold) {
  service_.streams = {[](const v1::WatchRequest&, Writer* writer) {
    send_frame(writer, 3, false);
    send_frame(writer, 4, true);
    return grpc::Status::OK;
  }};
  service_.acknowledgement = grpc::Status(grpc::StatusCode::PERMISSION_DENIED, "not yours");
  const LocalServer server(&service_);
  v1::WatchRequest request;
  request.set_max_unacknowledged_frames(1);
  EXPECT_TRUE(absl::IsPermissionDenied(watch(Connection(server.address()), request, handlers())));
}

TEST_F(FrameWatcherTest, ASilentDaemonIsABrokenStream) {
  std::promise<void> told;
  service_.streams = {[&told](const v1::WatchRequest&, Writer* writer) {
                        send_frame(writer, 3, false);
                        told.get_future().wait();
                        return grpc::Status::OK;
                      },
                      [](const v1::WatchRequest&, Writer* writer) {
                        v1::WatchResponse response;
                        response.mutable_heartbeat();
                        for (int k = 0; k < 15; ++k) {
                          std::this_thread::sleep_for(std::chrono::milliseconds(100));
                          writer->Write(response);
                        }
                        send_frame(writer, 5, true);
                        return grpc::Status::OK;
                      }};
  const LocalServer server(&service_);
  v1::WatchRequest request;
  request.set_heartbeat_ms(250);
  WatchHandlers noting = handlers();
  absl::Status reason;
  noting.on_resume = [&](const absl::Status& status) {
    if (reason.ok()) told.set_value();
    reason = status;
  };
  EXPECT_TRUE(watch(Connection(server.address()), request, noting).ok());
  EXPECT_THAT(std::string(reason.message()), HasSubstr("not even a heartbeat"));
  EXPECT_THAT(frames_, ElementsAre(3, 5)) << "heartbeats for longer than that are no silence";
}

TEST_F(FrameWatcherTest, ADaemonThatDoesNotAnswerAnAcknowledgementIsSilentToo) {
  std::promise<void> told;
  const std::shared_future<void> resumed(told.get_future());
  service_.streams = {[resumed](const v1::WatchRequest&, Writer* writer) {
                        send_frame(writer, 3, false);
                        resumed.wait();
                        return grpc::Status::OK;
                      },
                      [](const v1::WatchRequest&, Writer* writer) {
                        send_frame(writer, 4, true);
                        return grpc::Status::OK;
                      }};
  service_.on_acknowledge = [resumed] { resumed.wait(); };
  const LocalServer server(&service_);
  v1::WatchRequest request;
  request.set_heartbeat_ms(250);
  request.set_max_unacknowledged_frames(1);
  WatchHandlers noting = handlers();
  absl::Status reason;
  noting.on_resume = [&](const absl::Status& status) {
    if (reason.ok()) told.set_value();
    reason = status;
  };
  EXPECT_TRUE(watch(Connection(server.address()), request, noting).ok());
  EXPECT_THAT(std::string(reason.message()), HasSubstr("not even a heartbeat"));
  EXPECT_THAT(frames_, ElementsAre(3, 4));
}

TEST_F(FrameWatcherTest, AnErrorOfTheSimulationIsNotRetried) {
  service_.streams = {
      [](const v1::WatchRequest&, Writer*) { return grpc::Status(grpc::StatusCode::NOT_FOUND, "no such simulation"); }};
  const LocalServer server(&service_);
  EXPECT_TRUE(absl::IsNotFound(watch(Connection(server.address()), {}, handlers())));
  EXPECT_EQ(service_.requests.size(), 1u);
}

TEST_F(FrameWatcherTest, AHandlersErrorEndsTheWatch) {
  service_.streams = {[](const v1::WatchRequest&, Writer* writer) {
    send_frame(writer, 1, false);
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
  }};
  const LocalServer server(&service_);
  WatchHandlers full = handlers();
  full.on_frame = [](const Frame&) { return absl::InvalidArgumentError("the disk is full"); };
  EXPECT_EQ(watch(Connection(server.address()), {}, full).message(), "the disk is full");
}

TEST_F(FrameWatcherTest, StopEndsAWatchThatWaits) {
  std::stop_source stop;
  service_.streams = {[&stop](const v1::WatchRequest&, Writer* writer) {
    send_frame(writer, 1, false);
    stop.request_stop();
    for (int i = 0; i < 500; ++i) {
      v1::WatchResponse nothing;
      if (!writer->Write(nothing)) return grpc::Status::CANCELLED;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return grpc::Status::OK;
  }};
  const LocalServer server(&service_);
  EXPECT_TRUE(absl::IsCancelled(watch(Connection(server.address(), stop.get_token()), {}, handlers())));
}

}  // namespace
}  // namespace lipofill::client
