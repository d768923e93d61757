#include "server/frames/outgoing_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <prometheus/text_serializer.h>

#include "lipofill/v1/frame_service.pb.h"
#include "server/ops/metrics.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

const Selection kSkin = {{"skin"}};

TopologyToSend meshes() {
  auto made = std::make_shared<Topology>();
  made->meshes = {{"skin", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, 3}};
  return {made};
}

FrameToSend frame(uint64_t sequence, uint64_t skipped) {
  auto made = std::make_shared<Frame>();
  made->epoch = 5;
  made->sequence = sequence;
  made->fields = {{"skin", "pressure", "Pa", simulation::FieldLocation::kPoint, 1, {1.0f, 2.0f, 3.0f}}};
  return {made, skipped};
}

class OutgoingMessagesTest : public ::testing::Test {
 protected:
  /// The next message, as a client reads it.
  v1::WatchResponse take(OutgoingMessages& messages) {
    grpc::ByteBuffer bytes;
    messages.take_next(bytes);
    std::vector<grpc::Slice> slices;
    EXPECT_TRUE(bytes.Dump(&slices).ok());
    std::string whole;
    for (const grpc::Slice& slice : slices) whole.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
    v1::WatchResponse response;
    EXPECT_TRUE(response.ParseFromString(whole));
    return response;
  }

  Metrics metrics_;
};

TEST_F(OutgoingMessagesTest, FramesNameTheMeshesThatWereSent) {
  OutgoingMessages messages(metrics_.viewers(), "");
  EXPECT_TRUE(messages.empty());
  messages.add(meshes(), kSkin);
  messages.add(frame(9, 2), kSkin);
  const v1::WatchResponse mesh = take(messages);
  ASSERT_TRUE(mesh.has_mesh());
  EXPECT_TRUE(mesh.mesh().last());
  const v1::WatchResponse shown = take(messages);
  ASSERT_TRUE(shown.has_frame());
  EXPECT_EQ(shown.frame().topology_hash(), mesh.mesh().topology_hash());
  EXPECT_EQ(shown.frame().sequence(), 9u);
  EXPECT_EQ(shown.frame().skipped_frames(), 2u);
  EXPECT_TRUE(messages.empty());
  const prometheus::TextSerializer serializer;
  const std::string text = serializer.prometheus::Serializer::Serialize(metrics_.collect());
  EXPECT_THAT(text, HasSubstr("lipofill_frames_sent_total 1"));
  EXPECT_THAT(text, HasSubstr("lipofill_frames_skipped_total 2"));
}

TEST_F(OutgoingMessagesTest, MeshesThatTheClientHasAreNotSentAgain) {
  OutgoingMessages first(metrics_.viewers(), "");
  first.add(meshes(), kSkin);
  const std::string hash = take(first).mesh().topology_hash();
  OutgoingMessages again(metrics_.viewers(), hash);
  again.add(meshes(), kSkin);
  EXPECT_TRUE(again.empty());
  again.add(frame(1, 0), kSkin);
  EXPECT_EQ(take(again).frame().topology_hash(), hash);
}

TEST_F(OutgoingMessagesTest, AHeartbeatRepeatsThePlaceOfTheLastFrame) {
  OutgoingMessages messages(metrics_.viewers(), "");
  messages.add_heartbeat(0);
  EXPECT_EQ(take(messages).heartbeat().epoch(), 0u) << "none was sent";
  messages.add(frame(9, 0), kSkin);
  messages.clear();
  messages.add_heartbeat(3);
  const v1::WatchResponse beat = take(messages);
  EXPECT_EQ(beat.heartbeat().epoch(), 5u);
  EXPECT_EQ(beat.heartbeat().sequence(), 9u);
  EXPECT_EQ(beat.heartbeat().unacknowledged_frames(), 3u);
}

TEST_F(OutgoingMessagesTest, SharesTheBytesOfViewersOfTheSameSelection) {
  OutgoingMessages one(metrics_.viewers(), "");
  OutgoingMessages other(metrics_.viewers(), "");
  const FrameToSend shown = frame(9, 0);
  const FrameToSend late{shown.frame, 7};
  one.add(shown, kSkin);
  other.add(late, kSkin);
  const auto body_of = [](OutgoingMessages& messages) {
    grpc::ByteBuffer bytes;
    messages.take_next(bytes);
    std::vector<grpc::Slice> slices;
    EXPECT_TRUE(bytes.Dump(&slices).ok());
    return slices.at(1).begin();
  };
  EXPECT_EQ(body_of(one), body_of(other));
}

}  // namespace
}  // namespace lipofill::server
