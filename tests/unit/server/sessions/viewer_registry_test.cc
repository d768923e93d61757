#include "server/sessions/viewer_registry.h"

#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

std::shared_ptr<Viewer> make_viewer() {
  return std::make_shared<Viewer>(ViewerOptions(), [] {});
}

TEST(ViewerRegistry, FindsByBothNames) {
  ViewerRegistry registry;
  const auto a = make_viewer();
  const auto b = make_viewer();
  registry.add("one", "a", a);
  registry.add("two", "a", b);
  EXPECT_EQ(registry.find("one", "a"), a);
  EXPECT_EQ(registry.find("two", "a"), b);
  EXPECT_EQ(registry.find("one", "b"), nullptr);
  registry.remove("one", "a", a);
  EXPECT_EQ(registry.find("one", "a"), nullptr);
  EXPECT_EQ(registry.find("two", "a"), b);
}

TEST(ViewerRegistry, TheNewestOfANameTakesThePlace) {
  ViewerRegistry registry;
  const auto former = make_viewer();
  const auto newest = make_viewer();
  registry.add("one", "a", former);
  registry.add("one", "a", newest);
  EXPECT_TRUE(former->closed());
  EXPECT_FALSE(newest->closed());
  EXPECT_TRUE(absl::IsAborted(std::get<EndOfStream>(former->take()).status));
  registry.remove("one", "a", former);
  EXPECT_EQ(registry.find("one", "a"), newest) << "its end does not take the newer one along";
}

}  // namespace
}  // namespace lipofill::server
