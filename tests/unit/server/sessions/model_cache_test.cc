#include "server/sessions/model_cache.h"

#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

ModelCache::Build counting(int& builds) {
  return [&builds]() -> absl::StatusOr<ModelCache::Model> {
    ++builds;
    return std::make_shared<const model::FaceModel>();
  };
}

TEST(ModelCache, BuildsOnceAndForgetsTheLeastRecentlyUsed) {
  ModelCache cache(2);
  int builds = 0;
  const auto a = cache.get("a", counting(builds));
  ASSERT_TRUE(a.ok());
  ASSERT_TRUE(cache.get("b", counting(builds)).ok());
  EXPECT_EQ(*cache.get("a", counting(builds)), *a);
  EXPECT_EQ(builds, 2);
  ASSERT_TRUE(cache.get("c", counting(builds)).ok());  // b goes
  EXPECT_EQ(cache.size(), 2u);
  EXPECT_EQ(*cache.get("a", counting(builds)), *a);
  EXPECT_EQ(builds, 3);
  ASSERT_TRUE(cache.get("b", counting(builds)).ok());
  EXPECT_EQ(builds, 4);
}

TEST(ModelCache, DoesNotKeepAFailure) {
  ModelCache cache(2);
  EXPECT_FALSE(cache.get("a", []() -> absl::StatusOr<ModelCache::Model> { return absl::DataLossError("x"); }).ok());
  EXPECT_EQ(cache.size(), 0u);
  int builds = 0;
  EXPECT_TRUE(cache.get("a", counting(builds)).ok());
  cache.remove("a");
  EXPECT_EQ(cache.size(), 0u);
}

}  // namespace
}  // namespace lipofill::server
