#include "server/wire/frame_encoding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;

std::shared_ptr<const Frame> big_frame(size_t points) {
  auto made = std::make_shared<Frame>();
  Frame& frame = *made;
  frame.epoch = 3;
  frame.sequence = 70;
  frame.time_s = 0.7;
  simulation::FrameField displacement{"skin", "displacement", "mm", simulation::FieldLocation::kPoint, 3, {}};
  for (size_t i = 0; i < 3 * points; ++i) displacement.values.push_back(static_cast<float>(i));
  frame.fields.push_back(displacement);
  frame.fields.push_back({"film/deep", "wet", "", simulation::FieldLocation::kCell, 1, {1.0f, 0.0f}});
  return made;
}

/// What a client sees.
v1::FrameSlice receive(const std::string& body, uint64_t skipped) {
  v1::WatchResponse response;
  EXPECT_TRUE(response.ParseFromString(frame_header(body.size(), skipped) + body));
  EXPECT_TRUE(response.has_frame());
  return response.frame();
}

TEST(FrameEncoding, GoesRoundWithTheSkippedFrames) {
  const auto made = big_frame(2);
  const Frame& frame = *made;
  const auto encoded = encode_shared(frame, {{"film/deep", "skin"}}, "hash");
  ASSERT_EQ(encoded->messages.size(), 1u);
  for (const uint64_t skipped : {uint64_t{0}, uint64_t{1}, uint64_t{300}, ~uint64_t{0}}) {
    const v1::FrameSlice slice = receive(encoded->messages[0], skipped);
    EXPECT_EQ(slice.skipped_frames(), skipped);
    EXPECT_EQ(slice.sequence(), 70u);
    EXPECT_EQ(slice.topology_hash(), "hash");
    EXPECT_TRUE(slice.last());
    EXPECT_FALSE(slice.end());
    ASSERT_EQ(slice.fields_size(), 2);
    EXPECT_EQ(slice.fields(0).name(), "skin.displacement");
    EXPECT_THAT(slice.fields(0).shape(), ElementsAre(2, 3));
    EXPECT_EQ(slice.fields(1).location(), v1::CELL);
    EXPECT_THAT(slice.fields(1).shape(), ElementsAre(2));
    float value = 0;
    std::memcpy(&value, slice.fields(0).data().data() + 5 * sizeof(float), sizeof value);
    EXPECT_EQ(value, 5.0f);
  }
}

TEST(FrameEncoding, MarksAPreviewAndLeavesOutMeshesItHasNot) {
  Frame frame;
  frame.preview = true;
  frame.fields.push_back({"skin", "pressure", "Pa", simulation::FieldLocation::kPoint, 1, {1.0f}});
  const auto encoded = encode_shared(frame, {{"film/deep", "skin"}}, "hash");
  ASSERT_EQ(encoded->messages.size(), 1u);
  const v1::FrameSlice slice = receive(encoded->messages[0], 0);
  EXPECT_TRUE(slice.preview());
  EXPECT_TRUE(slice.last());
  ASSERT_EQ(slice.fields_size(), 1);
  EXPECT_EQ(slice.fields(0).name(), "skin.pressure");
}

TEST(FrameEncoding, SharesOneEncodingASetOfMeshes) {
  const auto made = big_frame(2);
  const Frame& frame = *made;
  EXPECT_EQ(encode_shared(frame, {{"skin"}}, "h"), encode_shared(frame, {{"skin"}}, "h"));
  const auto film = encode_shared(frame, {{"film/deep"}}, "h2");
  const v1::FrameSlice slice = receive(film->messages[0], 0);
  ASSERT_EQ(slice.fields_size(), 1);
  EXPECT_EQ(slice.fields(0).name(), "film/deep.wet");
}

TEST(FrameEncoding, SendsTheFieldsAskedForInTheTypeAskedFor) {
  const auto made = big_frame(300'000);  // 1.8 MB of codes
  const Selection selection{{"film/deep", "skin"}, {"skin.displacement"}, true};
  const auto encoded = encode_shared(*made, selection, "h");
  EXPECT_NE(encoded, encode_shared(*made, {{"film/deep", "skin"}}, "h"));
  EXPECT_NE(encoded, encode_shared(*made, {{"film/deep", "skin"}, {"skin.displacement"}}, "h"));
  EXPECT_EQ(encoded, encode_shared(*made, selection, "h"));
  ASSERT_EQ(encoded->messages.size(), 2u);
  size_t bytes = 0;
  for (const std::string& message : encoded->messages) {
    const v1::FrameSlice slice = receive(message, 0);
    ASSERT_EQ(slice.fields_size(), 1);
    EXPECT_EQ(slice.fields(0).type(), v1::UINT16);
    EXPECT_EQ(slice.fields(0).box_max_size(), 3) << "every slice can be read on its own";
    EXPECT_GT(slice.fields(0).max_error(), 0.0);
    bytes += slice.fields(0).data().size();
  }
  EXPECT_EQ(bytes, 300'000u * 3 * 2);

  v1::FrameSlice kept = to_whole_frame(*made, {{"film/deep", "skin"}});
  select_fields(selection, kept);
  EXPECT_EQ(kept.SerializeAsString(), to_whole_frame(*made, selection).SerializeAsString());
}

TEST(FrameEncoding, CutsLargeArraysAndLosesNoByte) {
  const size_t points = 200'000;  // 2.4 MB
  const auto made = big_frame(points);
  const Frame& frame = *made;
  const auto encoded = encode_shared(frame, {{"film/deep", "skin"}}, "h");
  ASSERT_EQ(encoded->messages.size(), 3u);
  std::string bytes;
  for (size_t i = 0; i < encoded->messages.size(); ++i) {
    EXPECT_LE(encoded->messages[i].size(), kMaxSliceBytes + 1000);
    const v1::FrameSlice slice = receive(encoded->messages[i], 0);
    EXPECT_EQ(slice.last(), i == 2);
    EXPECT_EQ(slice.fields(0).offset_bytes(), bytes.size());
    bytes += slice.fields(0).data();
  }
  ASSERT_EQ(bytes.size(), 3 * points * sizeof(float));
  EXPECT_EQ(std::memcmp(bytes.data(), frame.fields[0].values.data(), bytes.size()), 0);
}

TEST(FrameEncoding, PointsFarFromTheOriginComeInDoublePrecision) {
  Topology topology;
  topology.meshes.push_back({"skin", {-1024, 0, 0.1, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, 3});
  topology.meshes.push_back({"scan", {5e8 + 0.001, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, 3});
  const v1::MeshSlice whole = to_whole_meshes(topology, {"skin", "scan"});
  EXPECT_EQ(whole.arrays(0).type(), v1::FLOAT32);
  EXPECT_EQ(whole.arrays(0).data().size(), 9 * sizeof(float));
  ASSERT_EQ(whole.arrays(2).type(), v1::FLOAT64);
  ASSERT_EQ(whole.arrays(2).data().size(), 9 * sizeof(double));
  EXPECT_EQ(std::memcmp(whole.arrays(2).data().data(), topology.meshes[1].points_mm.data(), 9 * sizeof(double)), 0);
}

TEST(FrameEncoding, HashesMeshesByContent) {
  Topology topology;
  topology.meshes.push_back({"skin", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, 3});
  topology.meshes.push_back({"film/a.b", {0, 0, 0}, {}, 4});
  const auto all = encode_shared(topology, {"film/a.b", "skin"});
  const auto skin = encode_shared(topology, {"skin"});
  EXPECT_NE(all->topology_hash, skin->topology_hash);
  v1::MeshSlice kept = to_whole_meshes(topology, {"film/a.b", "skin"});
  EXPECT_THAT(mesh_names(kept), ElementsAre("skin", "film/a.b"));
  select_meshes({"skin"}, *kept.mutable_arrays());
  EXPECT_EQ(compute_topology_hash(kept), skin->topology_hash);
  topology.meshes[0].points_mm[4] = 2;
  EXPECT_NE(to_whole_meshes(topology, {"skin"}).topology_hash(), skin->topology_hash);

  v1::WatchResponse response;
  ASSERT_TRUE(response.ParseFromString(skin->messages[0]));
  EXPECT_TRUE(response.mesh().last());
  EXPECT_THAT(response.mesh().arrays(1).shape(), ElementsAre(1, 3));
}

}  // namespace
}  // namespace lipofill::server
