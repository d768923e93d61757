#include "server/sessions/shown_bytes.h"

#include <gtest/gtest.h>

#include <utility>

#include "server/sessions/frame.h"

namespace lipofill::server {
namespace {

TEST(ShownBytes, AreCountedAsLongAsTheyAreThere) {
  const uint64_t before = shown_bytes();
  {
    ShownBytes bytes(40);
    EXPECT_EQ(shown_bytes(), before + 40);
    const ShownBytes elsewhere = std::move(bytes);
    EXPECT_EQ(shown_bytes(), before + 40);
    bytes = ShownBytes(2);
    EXPECT_EQ(shown_bytes(), before + 42);
  }
  EXPECT_EQ(shown_bytes(), before);
}

TEST(EncodingCache, ForgetsWhatNobodySendsOnceThereAreMany) {
  const EncodingCache cache;
  int made = 0;
  const auto get = [&](const std::string& key) {
    return cache.get(key, [&] {
      ++made;
      return EncodedMessages{key, {}, {}};
    });
  };
  const auto held = get("0");
  for (size_t i = 1; i < EncodingCache::kMostKept; ++i) get(std::to_string(i));
  get("0");
  EXPECT_EQ(made, static_cast<int>(EncodingCache::kMostKept));
  get("new");
  get("1");
  EXPECT_EQ(made, static_cast<int>(EncodingCache::kMostKept) + 2) << "it was forgotten";
  EXPECT_EQ(get("0"), held);
}

}  // namespace
}  // namespace lipofill::server
