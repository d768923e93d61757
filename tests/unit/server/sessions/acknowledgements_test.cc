#include "server/sessions/acknowledgements.h"

#include <gtest/gtest.h>

#include "core/base/field_violations.h"

namespace lipofill::server {
namespace {

TEST(Acknowledgements, WaitsWhileSoManyAreOnTheirWay) {
  Acknowledgements frames(2);
  frames.note_sent(5, 10);
  EXPECT_FALSE(frames.must_wait());
  frames.note_sent(5, 20);
  EXPECT_TRUE(frames.must_wait());
  ASSERT_TRUE(frames.acknowledge(5, 10).ok());
  EXPECT_EQ(frames.on_their_way(), 1u);
  EXPECT_FALSE(frames.must_wait());
  ASSERT_TRUE(frames.acknowledge(5, 20).ok());
  EXPECT_EQ(frames.on_their_way(), 0u);
}

TEST(Acknowledgements, OneStandsForAllBeforeIt) {
  Acknowledgements frames(3);
  for (const uint64_t sequence : {10, 20, 30}) frames.note_sent(5, sequence);
  ASSERT_TRUE(frames.acknowledge(5, 25).ok());
  EXPECT_EQ(frames.on_their_way(), 1u);
}

TEST(Acknowledgements, NamesAFrameThatWasNotSent) {
  Acknowledgements frames(3);
  frames.note_sent(5, 10);
  const absl::Status later = frames.acknowledge(5, 11);
  EXPECT_TRUE(absl::IsInvalidArgument(later));
  EXPECT_EQ(field_violations_of(later).at(0).field, "sequence");
  EXPECT_EQ(field_violations_of(frames.acknowledge(6, 1)).at(0).field, "epoch");
  EXPECT_EQ(frames.on_their_way(), 1u);
  EXPECT_TRUE(frames.acknowledge(4, 99).ok()) << "it was under way when the simulation went back";
  EXPECT_EQ(frames.on_their_way(), 1u);
}

TEST(Acknowledgements, CountsNoneWithoutABound) {
  Acknowledgements frames(0);
  for (uint64_t sequence = 1; sequence <= 1000; ++sequence) frames.note_sent(5, sequence);
  EXPECT_EQ(frames.on_their_way(), 0u);
  EXPECT_FALSE(frames.must_wait());
}

}  // namespace
}  // namespace lipofill::server
