#include "server/backend/kept_result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/field_violations.h"
#include "tests/unit/server/backend/backend_fixture.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

class KeptResultTest : public BackendTest {
 protected:
  KeptResultTest() {
    create("a", 0.05, true);
    await_end("a");
  }
  static ViewerOptions options(std::vector<std::string> meshes, std::vector<std::string> fields = {}) {
    ViewerOptions chosen;
    chosen.selection.meshes = std::move(meshes);
    chosen.selection.fields = std::move(fields);
    return chosen;
  }
  /// The one slice of a frame that a client sees.
  static v1::FrameSlice frame_of(const KeptMessages& messages) {
    v1::FrameSlice slice;
    EXPECT_EQ(messages.frame.messages.size(), 1u);
    EXPECT_TRUE(slice.ParseFromString(messages.frame.messages.at(0)));
    return slice;
  }

  KeptResults results_{*store_};
};

TEST_F(KeptResultTest, ShowsTheLastFrameWithItsMeshes) {
  const auto shown = results_.show("a", options({}));
  ASSERT_TRUE(shown.ok()) << shown.status();
  v1::WatchResponse mesh;
  ASSERT_TRUE(mesh.ParseFromString((*shown)->meshes.messages.at(0)));
  EXPECT_EQ(mesh.mesh().arrays(0).name(), "skin.points");
  const v1::FrameSlice frame = frame_of(**shown);
  EXPECT_TRUE(frame.end());
  EXPECT_EQ(frame.sequence(), 5u);
  EXPECT_EQ(frame.topology_hash(), mesh.mesh().topology_hash());
  EXPECT_EQ((*shown)->meshes.topology_hash, mesh.mesh().topology_hash());
}

TEST_F(KeptResultTest, ShowsWhatIsSelected) {
  const auto shown = results_.show("a", options({"film/plane"}, {"film/plane.thickness"}));
  ASSERT_TRUE(shown.ok()) << shown.status();
  const v1::FrameSlice frame = frame_of(**shown);
  ASSERT_EQ(frame.fields_size(), 1);
  EXPECT_EQ(frame.fields(0).name(), "film/plane.thickness");
  EXPECT_EQ(frame.fields(0).type(), v1::FLOAT32);
  ViewerOptions small = options({"film/plane"}, {"film/plane.thickness"});
  small.selection.quantised = true;
  const auto quantised = results_.show("a", small);
  ASSERT_TRUE(quantised.ok()) << quantised.status();
  EXPECT_EQ(frame_of(**quantised).fields(0).type(), v1::UINT16);
}

TEST_F(KeptResultTest, ThoseWhoAskForTheSameShareTheMessages) {
  const auto one = results_.show("a", options({"skin"}));
  const auto other = results_.show("a", options({"skin"}));
  ASSERT_TRUE(one.ok() && other.ok());
  EXPECT_EQ(*one, *other);
  const auto film = results_.show("a", options({"film/plane"}));
  ASSERT_TRUE(film.ok());
  EXPECT_NE(*one, *film);
  ASSERT_TRUE(delete_simulation_record(*backend_, "a").ok());
  create("a", 0.07, true);
  await_end("a");
  const auto anew = results_.show("a", options({"skin"}));
  ASSERT_TRUE(anew.ok()) << anew.status();
  EXPECT_EQ(frame_of(**anew).sequence(), 7u) << "another simulation of the same name";
}

TEST_F(KeptResultTest, InWhateverOrderTheyAskForIt) {
  const std::string pressure = "film/plane.pressure", thickness = "film/plane.thickness";
  const auto first = results_.show("a", options({"film/plane"}, {pressure, thickness}));
  const auto second = results_.show("a", options({"film/plane"}, {thickness, pressure, thickness}));
  ASSERT_TRUE(first.ok() && second.ok()) << first.status() << second.status();
  EXPECT_EQ(*first, *second);
}

TEST_F(KeptResultTest, NamesWhatThereIsNot) {
  EXPECT_TRUE(absl::IsNotFound(results_.show("b", options({})).status()));
  const auto mesh = results_.show("a", options({"skin", "bone"}));
  EXPECT_TRUE(absl::IsInvalidArgument(mesh.status()));
  EXPECT_EQ(field_violations_of(mesh.status()).at(0).field, "meshes[1]");
  const auto field = results_.show("a", options({"skin"}, {"skin.colour"}));
  EXPECT_EQ(field_violations_of(field.status()).at(0).field, "fields[0]");
  EXPECT_THAT(field.status().ToString(), HasSubstr("skin.displacement"));
  create("running", 1e6);
  EXPECT_FALSE(results_.show("running", options({})).ok()) << "it has not ended";
}

TEST_F(KeptResultTest, SaysThatAResultIsDamaged) {
  create("b", 0.05);
  SimulationRecord ended = record_of("b");
  ended.state = SimulationState::kFinished;
  ASSERT_TRUE(store_->end_simulation(ended, {"\xff\xff", "\xff\xff"}).ok());
  const auto shown = results_.show("b", options({}));
  EXPECT_TRUE(absl::IsDataLoss(shown.status()));
  EXPECT_THAT(shown.status().ToString(), HasSubstr("simulations/b"));
}

}  // namespace
}  // namespace lipofill::server
