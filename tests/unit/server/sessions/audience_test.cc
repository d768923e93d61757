#include "server/sessions/audience.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/sessions/viewer_frames.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;

std::shared_ptr<Viewer> viewer(ViewerOptions options = {}) {
  return std::make_shared<Viewer>(std::move(options), [] {});
}

std::shared_ptr<Viewer> viewer_of(const std::string& mesh, double interval_s = 0.0) {
  ViewerOptions options;
  options.selection.meshes = {mesh};
  options.interval_s = interval_s;
  return viewer(options);
}

TEST(Audience, MakesOneFrameWithTheMeshesOfThoseWhoWantIt) {
  Audience audience;
  const auto first = viewer_of("skin");
  const auto second = viewer_of("scan");
  const auto later = viewer_of("tissue", 10.0);
  for (const auto& v : {first, second, later}) audience.join(v);
  later->offer(frame(0));
  EXPECT_EQ(take_frame(*later).frame->sequence, 0u);
  int made = 0;
  audience.show(1.0, false, [&](const std::set<std::string>& meshes) {
    ++made;
    EXPECT_THAT(meshes, ElementsAre("scan", "skin")) << "what is due later needs no mesh";
    return frame(1, 1.0);
  });
  EXPECT_EQ(made, 1);
  EXPECT_EQ(take_frame(*first).frame, take_frame(*second).frame);
  EXPECT_TRUE(has_nothing(*later));
}

TEST(Audience, MakesNoFrameThatNobodyWants) {
  Audience audience;
  const auto make = [](const std::set<std::string>&) -> std::shared_ptr<const Frame> {
    ADD_FAILURE() << "a frame for nobody";
    return frame(1);
  };
  EXPECT_TRUE(audience.empty());
  audience.show(1.0, true, make);
  const auto left = viewer();
  audience.join(left);
  EXPECT_FALSE(audience.empty());
  left->close(absl::OkStatus());
  audience.show(1.0, true, make);
  EXPECT_TRUE(audience.empty()) << "whose stream has ended is no viewer any more";
}

TEST(Audience, SharesTheRateAmongThoseWhoAskForNone) {
  const auto at = [](int ms) { return Viewer::Clock::time_point(std::chrono::milliseconds(ms)); };
  const auto period_ms = [&](Viewer& v) {
    v.rewind();
    v.offer(frame(1));
    EXPECT_TRUE(std::holds_alternative<FrameToSend>(v.take(at(0))));
    int ms = 0;
    while (!v.wants(0.0, false, at(ms))) ++ms;
    return ms;
  };
  ViewerOptions shared;
  shared.shares_rate = true;
  Audience audience;
  std::vector<std::shared_ptr<Viewer>> viewers;
  for (int k = 0; k < 48; ++k) {
    viewers.push_back(viewer(shared));
    audience.join(viewers.back());
  }
  EXPECT_EQ(period_ms(*viewers[0]), 100) << "480 frames a second for 48";
  while (viewers.size() > 8) {
    audience.leave(viewers.back());
    viewers.pop_back();
  }
  EXPECT_EQ(period_ms(*viewers[0]), 17) << "no more than a screen shows";
}

TEST(Audience, EndsEveryStream) {
  Audience audience;
  const auto one = viewer();
  audience.join(one);
  audience.close(absl::UnavailableError("draining"));
  EXPECT_TRUE(audience.empty());
  EXPECT_TRUE(absl::IsUnavailable(take_end(*one)));
}

TEST(Audience, ThoseWhoAreDismissedKeepWhatTheyWereOffered) {
  Audience audience;
  const auto one = viewer();
  audience.join(one);
  audience.offer(frame(7, 0.0, true));
  audience.dismiss();
  EXPECT_EQ(take_frame(*one).frame->sequence, 7u);
  EXPECT_TRUE(take_end(*one).ok());
}

}  // namespace
}  // namespace lipofill::server
