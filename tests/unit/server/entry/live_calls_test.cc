// What is counted of calls under way. Calls that are ended need a real one: see
// tests/integration/security/unread_test.cc.

#include "server/entry/live_calls.h"

#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

class LiveCallsTest : public ::testing::Test {
 protected:
  uint64_t add(const std::string& subject) {
    Principal principal;
    principal.scope.tenant = "ward";
    principal.subject = subject;
    return calls_.add(nullptr, principal);
  }

  LiveCalls calls_{CallBounds{.messages = {100, 60}, .streams = {500, 100, true}}};
};

TEST_F(LiveCallsTest, ARequestCountsUntilItsCallEnds) {
  const uint64_t first = add("anna");
  ASSERT_TRUE(calls_.keep_request(first, 50).ok());
  ASSERT_TRUE(calls_.keep_request(first, 20).ok());
  EXPECT_EQ(calls_.bytes(), 20u) << "a message of a stream takes the place of the one before";
  const uint64_t second = add("anna");
  EXPECT_TRUE(absl::IsResourceExhausted(calls_.keep_request(second, 50)));
  EXPECT_EQ(calls_.bytes(), 20u) << "what is refused is not counted";
  calls_.remove(first);
  EXPECT_TRUE(calls_.keep_request(second, 50).ok());
  calls_.remove(second);
  EXPECT_EQ(calls_.bytes(), 0u);
}

TEST_F(LiveCallsTest, AnAnswerCountsUntilItIsRead) {
  const uint64_t call = add("anna");
  ASSERT_TRUE(calls_.begin_answer(call, 60).ok());
  EXPECT_EQ(calls_.bytes(), 60u);
  calls_.end_answer(call);
  EXPECT_EQ(calls_.bytes(), 0u);
  ASSERT_TRUE(calls_.begin_answer(call, 60).ok());
  calls_.remove(call);
  EXPECT_EQ(calls_.bytes(), 0u) << "its caller has left";
}

TEST_F(LiveCallsTest, KeptAnswersAreLetGoOfAsTheyAreSent) {
  const uint64_t call = add("anna");
  ASSERT_TRUE(calls_.keep_answers(call, 120).ok());
  ASSERT_TRUE(calls_.begin_answer(call, 50).ok());
  EXPECT_EQ(calls_.bytes(), 120u) << "one is on its way, and counted once";
  calls_.end_answer(call);
  EXPECT_EQ(calls_.bytes(), 70u);
  EXPECT_TRUE(absl::IsResourceExhausted(calls_.keep_answers(add("anna"), 50)));
  EXPECT_TRUE(calls_.keep_answers(add("bert"), 50).ok());
  calls_.remove(call);
  EXPECT_EQ(calls_.bytes(), 50u);
}

TEST_F(LiveCallsTest, CallsWithinTheirNumberGoOn) {
  LiveCalls calls(CallBounds{.calls = 3, .calls_of_caller = 2});
  Principal anna;
  anna.subject = "anna";
  const uint64_t first = calls.add(nullptr, anna);
  EXPECT_TRUE(calls.check_number_of_calls(first).ok());
  EXPECT_TRUE(calls.check_number_of_calls(calls.add(nullptr, anna)).ok());
  EXPECT_TRUE(calls.check_number_of_calls(calls.add(nullptr, {})).ok());
  calls.remove(first);
  EXPECT_TRUE(calls.check_number_of_calls(calls.add(nullptr, anna)).ok()) << "one that has ended counts no more";
}

TEST_F(LiveCallsTest, FramesOfAViewerAreSharedAndNotItsOwn) {
  const uint64_t call = calls_.add(nullptr, {}, true);
  EXPECT_TRUE(calls_.begin_answer(call, 1'000'000).ok());
  EXPECT_EQ(calls_.bytes(), 0u);
}

}  // namespace
}  // namespace lipofill::server
