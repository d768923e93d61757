#include "server/sessions/operations.h"

#include <gtest/gtest.h>

#include <future>

namespace lipofill::server {
namespace {

using std::chrono::milliseconds;

std::future<absl::StatusOr<OperationView>> wait_for(Operations& operations, const std::string& id, milliseconds timeout,
                                                    std::optional<double> seen) {
  auto answer = std::make_shared<std::promise<absl::StatusOr<OperationView>>>();
  operations.wait(id, timeout, seen, [answer](absl::StatusOr<OperationView> view) { answer->set_value(view); });
  return answer->get_future();
}

TEST(Operations, GoesFromStartToResponse) {
  Operations operations;
  const auto started = operations.start("patients/anna", {});
  ASSERT_TRUE(started.ok());
  const std::string id = started->operation.id;
  EXPECT_TRUE(operations.report(id, 0.5, "charting"));
  EXPECT_EQ(operations.get(id)->stage, "charting");
  EXPECT_TRUE(operations.report(id, 0.25, "back"));
  EXPECT_EQ(operations.get(id)->progress, 0.5) << "progress does not go back";
  operations.finish(id, std::string("model"));
  const auto done = operations.get(id);
  EXPECT_TRUE(done->done);
  EXPECT_EQ(done->progress, 1.0);
  EXPECT_EQ(done->response_message, "model");
}

TEST(Operations, RepeatsARequestOnlyOnce) {
  Operations operations;
  const RequestKey key{"BuildModel", "r1", "f"};
  const auto first = operations.start("patients/anna", key);
  const auto again = operations.start("patients/anna", key);
  ASSERT_TRUE(again.ok());
  EXPECT_FALSE(again->is_new);
  EXPECT_EQ(again->operation.id, first->operation.id);
  EXPECT_TRUE(absl::IsInvalidArgument(operations.start("patients/anna", {"BuildModel", "r1", "g"}).status()));
}

TEST(Operations, CancellationReachesTheWork) {
  Operations operations;
  const std::string id = operations.start("t", {})->operation.id;
  ASSERT_TRUE(operations.cancel(id).ok());
  EXPECT_FALSE(operations.report(id, 0.1, "x"));
  operations.finish(id, absl::CancelledError("cancelled"));
  EXPECT_TRUE(absl::IsCancelled(operations.get(id)->error));
  EXPECT_TRUE(absl::IsNotFound(operations.cancel("none")));
}

TEST(Operations, WaitAnswersOnProgressEndAndTimeout) {
  Operations operations;
  const std::string id = operations.start("t", {})->operation.id;
  auto on_progress = wait_for(operations, id, milliseconds(60'000), 0.0);
  auto on_end = wait_for(operations, id, milliseconds(60'000), std::nullopt);
  auto on_timeout = wait_for(operations, id, milliseconds(20), std::nullopt);
  EXPECT_FALSE(on_timeout.get()->done);
  operations.report(id, 0.3, "x");
  EXPECT_EQ(on_progress.get()->progress, 0.3);
  EXPECT_EQ(wait_for(operations, id, milliseconds(60'000), 0.0).get()->progress, 0.3) << "at once: it has changed";
  operations.finish(id, std::string("r"));
  EXPECT_TRUE(on_end.get()->done);
  EXPECT_TRUE(absl::IsNotFound(wait_for(operations, "none", milliseconds(1), std::nullopt).get().status()));
}

TEST(Operations, StoppingAnswersWhoWaits) {
  Operations operations;
  const std::string id = operations.start("t", {})->operation.id;
  auto waiting = wait_for(operations, id, milliseconds(60'000), std::nullopt);
  operations.stop();
  EXPECT_TRUE(absl::IsUnavailable(waiting.get().status()));
  EXPECT_FALSE(operations.report(id, 0.5, "x"));
  EXPECT_TRUE(absl::IsUnavailable(operations.start("t", {}).status()));
}

TEST(Operations, RemembersABoundedNumber) {
  Operations operations;
  const std::string running = operations.start("t", {})->operation.id;
  for (int i = 0; i < 1100; ++i) operations.add_done("t", {}, "r");
  EXPECT_EQ(operations.list({}, {"", 5000}).size(), 1001u);
  EXPECT_TRUE(operations.get(running).ok());
}

TEST(Operations, BelongToATenantAndAPatient) {
  Operations operations;
  const RequestKey ours{"BuildModel", "r1", "f", "ward"};
  const std::string id = operations.start("patients/ward-a", ours)->operation.id;
  const auto theirs = operations.start("patients/clinic-a", {"BuildModel", "r1", "f", "clinic"});
  ASSERT_TRUE(theirs.ok());
  EXPECT_TRUE(theirs->is_new) << "a request id is a tenant's own";
  EXPECT_EQ(operations.owner_of(id)->tenant, "ward");
  EXPECT_EQ(operations.owner_of(id)->patient, "ward-a");
  EXPECT_TRUE(absl::IsNotFound(operations.owner_of("none").status()));
  ASSERT_EQ(operations.list({"ward"}, {"", 10}).size(), 1u);
  EXPECT_EQ(operations.list({"ward"}, {"", 10})[0].id, id);
  EXPECT_EQ(operations.list({"ward", {{"ward-b"}}}, {"", 10}).size(), 0u);
  EXPECT_EQ(operations.list({}, {"", 10}).size(), 0u);
}

}  // namespace
}  // namespace lipofill::server
