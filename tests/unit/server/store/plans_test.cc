#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "server/store/sql_store.h"
#include "server/store/verification.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PlansTest : public ::testing::Test {
 protected:
  PlansTest() {
    reopen();
    for (const char* patient : {"anna", "berta"}) {
      EXPECT_TRUE(store_->create_patient({patient, "", {}, 1}, {}).ok());
      ScanRecord scan;
      scan.patient = patient;
      scan.id = absl::StrCat("face-of-", patient);
      EXPECT_TRUE(store_->create_scan(scan, {}).ok());
    }
  }
  void reopen() {
    store_ = nullptr;
    auto store = SqlStore::open(directory_.file("lipofill.sqlite"));
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
  }
  static PlanRecord plan(const std::string& id, const std::string& content = "first") {
    PlanRecord record;
    record.patient = "anna";
    record.id = id;
    record.content_message = content;
    record.create_time_us = 3;
    return record;
  }
  /// Gives a plan other content, at a time of its own.
  absl::StatusOr<PlanRecord> change(const std::string& id, const std::string& content) {
    return store_->update_plan("anna", id, [&](PlanRecord present) -> absl::StatusOr<PlanRecord> {
      present.content_message = content;
      present.changes_message = "to " + content.substr(0, 9);
      present.update_time_us = ++now_us_;
      return present;
    });
  }
  std::vector<uint64_t> kept(const std::string& id) {
    std::vector<uint64_t> numbers;
    const auto revisions = store_->list_plan_revisions("anna", id);
    for (const PlanRevisionRecord& revision : *revisions) numbers.push_back(revision.number);
    return numbers;
  }
  std::vector<std::string> listed(const Scope& scope, const std::string& patient, const Page& page,
                                  uint64_t most_bytes = 1000) {
    std::vector<std::string> names;
    const auto found = store_->list_plans(scope, patient, page, most_bytes);
    for (const PlanRecord& plan : *found) names.push_back(absl::StrCat(plan.patient, "/", plan.id));
    return names;
  }
  void add_simulation(const std::string& id) {
    ASSERT_TRUE(store_->create_simulation({id, "patients/anna/models/m", "", "spec"}, {}).ok());
  }

  lipofill::testing::TemporaryDirectory directory_;
  std::unique_ptr<SqlStore> store_;
  int64_t now_us_ = 100;
};

TEST_F(PlansTest, AreKeptWithWhatTheyWere) {
  ASSERT_TRUE(store_->create_plan(plan("q"), {}).ok());
  ASSERT_TRUE(change("q", "second").ok());
  ASSERT_EQ(change("q", "third")->revision, 3u);
  reopen();
  const auto present = store_->get_plan("anna", "q");
  ASSERT_TRUE(present.ok()) << present.status();
  EXPECT_EQ(present->content_message, "third");
  EXPECT_EQ(present->revision, 3u);
  EXPECT_EQ(present->create_time_us, 3);
  EXPECT_EQ(present->update_time_us, 102);
  EXPECT_THAT(kept("q"), ElementsAre(3, 2, 1));
  const auto second = store_->get_plan_revision("anna", "q", 2);
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(second->content_message, "second");
  EXPECT_EQ(second->changes_message, "to second");
  EXPECT_EQ(second->create_time_us, 101);
  const auto none = store_->get_plan_revision("anna", "q", 4);
  EXPECT_TRUE(absl::IsNotFound(none.status()));
  EXPECT_THAT(std::string(none.status().message()), HasSubstr("those from 1 to 3 are kept"));
}

TEST_F(PlansTest, WhatStaysTheSameMakesNoRevisionAndWhatIsRefusedIsNotDone) {
  ASSERT_TRUE(store_->create_plan(plan("q"), {}).ok());
  EXPECT_EQ(change("q", "first")->revision, 1u);
  const auto refuse = [](const PlanRecord&) -> absl::StatusOr<PlanRecord> { return absl::AbortedError("no"); };
  EXPECT_TRUE(absl::IsAborted(store_->update_plan("anna", "q", refuse).status()));
  EXPECT_EQ(store_->get_plan("anna", "q")->content_message, "first");
  EXPECT_THAT(kept("q"), ElementsAre(1));
  EXPECT_TRUE(absl::IsNotFound(store_->update_plan("anna", "none", refuse).status()));
}

TEST_F(PlansTest, TheOldestRevisionsGoByNumberAndByBytes) {
  ASSERT_TRUE(store_->create_plan(plan("many"), {}).ok());
  for (int i = 0; i < kMaxPlanRevisions + 5; ++i) ASSERT_TRUE(change("many", absl::StrCat("content ", i)).ok());
  const auto numbers = kept("many");
  ASSERT_EQ(numbers.size(), static_cast<size_t>(kMaxPlanRevisions));
  EXPECT_EQ(numbers.front(), static_cast<uint64_t>(kMaxPlanRevisions) + 6);
  EXPECT_EQ(numbers.back(), 7u);

  ASSERT_TRUE(store_->create_plan(plan("large"), {}).ok());
  for (char letter = 'a'; letter <= 'f'; ++letter) {
    ASSERT_TRUE(change("large", std::string(kMaxPlanRevisionBytes / 4, letter)).ok());
  }
  EXPECT_THAT(kept("large"), ElementsAre(7, 6, 5, 4));
  ASSERT_TRUE(change("large", std::string(kMaxPlanRevisionBytes + 1, 'z')).ok());
  EXPECT_THAT(kept("large"), ElementsAre(8)) << "the newest stays whatever its size";
}

TEST_F(PlansTest, NameScansOfTheirOwnPatientAlone) {
  PlanRecord record = plan("q");
  record.scan = "face-of-berta";
  EXPECT_TRUE(absl::IsNotFound(store_->create_plan(record, {}).status()));
  record.scan = "face-of-anna";
  ASSERT_TRUE(store_->create_plan(record, {}).ok());
  const auto aim = [](PlanRecord present) -> absl::StatusOr<PlanRecord> {
    present.target = "face-of-berta";
    present.content_message = "aimed";
    return present;
  };
  EXPECT_TRUE(absl::IsNotFound(store_->update_plan("anna", "q", aim).status()));
  EXPECT_EQ(store_->get_plan("anna", "q")->content_message, "first");
  const absl::Status refused = store_->delete_scan("anna", "face-of-anna");
  EXPECT_TRUE(absl::IsFailedPrecondition(refused));
  EXPECT_EQ(refused.message(), "patients/anna/plans/q is for patients/anna/scans/face-of-anna");
  EXPECT_TRUE(store_->delete_scan("berta", "face-of-berta").ok());
}

TEST_F(PlansTest, AnEqualRequestMakesOnePlanAndAnIdIsTakenOnce) {
  const RequestKey key{"CreatePlan", "r", "f"};
  ASSERT_EQ(store_->create_plan(plan("q"), key)->id, "q");
  EXPECT_EQ(store_->create_plan(plan("other"), key)->id, "q");
  EXPECT_TRUE(absl::IsAlreadyExists(store_->create_plan(plan("q"), {}).status()));
  PlanRecord of_nobody = plan("q");
  of_nobody.patient = "clara";
  EXPECT_TRUE(absl::IsNotFound(store_->create_plan(of_nobody, {}).status()));
  ASSERT_TRUE(store_->delete_plan("anna", "q").ok());
  EXPECT_EQ(store_->create_plan(plan("other"), key)->id, "other") << "the request went with its plan";
}

TEST_F(PlansTest, AreListedByPageScopeAndBytes) {
  for (const char* id : {"c", "a", "b"}) ASSERT_TRUE(store_->create_plan(plan(id), {}).ok());
  PlanRecord hers = plan("a");
  hers.patient = "berta";
  ASSERT_TRUE(store_->create_plan(hers, {}).ok());
  EXPECT_THAT(listed({}, "anna", {}), ElementsAre("anna/a", "anna/b", "anna/c"));
  EXPECT_THAT(listed({}, "", {"anna/b", 10}), ElementsAre("anna/c", "berta/a"));
  EXPECT_THAT(listed({}, "", {"", 2}), ElementsAre("anna/a", "anna/b"));
  EXPECT_THAT(listed({}, "", {}, 5), ElementsAre("anna/a", "anna/b")) << "five bytes each";
  EXPECT_THAT(listed({"local", {{"berta"}}}, "", {}), ElementsAre("berta/a"));
  EXPECT_THAT(listed({"other"}, "", {}), IsEmpty());
  EXPECT_TRUE(absl::IsNotFound(store_->list_plans({}, "clara", {}, 1).status()));
}

TEST_F(PlansTest, APatientHasABoundedNumber) {
  for (int i = 0; i < kMaxPlansOfPatient; ++i) {
    ASSERT_TRUE(store_->create_plan(plan(absl::StrCat("q", i)), {}).ok());
  }
  const auto refused = store_->create_plan(plan("more"), {});
  EXPECT_TRUE(absl::IsFailedPrecondition(refused.status()));
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("has 1000 plans, the bound is 1000"));
}

TEST_F(PlansTest, RunsAreOfOnePlanAndGoWithTheirSimulation) {
  ASSERT_TRUE(store_->create_plan(plan("q"), {}).ok());
  ASSERT_TRUE(store_->create_plan(plan("r"), {}).ok());
  for (const char* id : {"s1", "s2"}) add_simulation(id);
  ASSERT_TRUE(store_->add_plan_run("anna", "q", {"s1", "hash", 1}).ok());
  ASSERT_TRUE(store_->add_plan_run("anna", "q", {"s2", "hash", 2}).ok());
  EXPECT_TRUE(store_->add_plan_run("anna", "q", {"s1", "later", 9}).ok()) << "once more";
  EXPECT_TRUE(absl::IsAlreadyExists(store_->add_plan_run("anna", "r", {"s1", "hash", 1})));
  EXPECT_TRUE(absl::IsNotFound(store_->add_plan_run("anna", "q", {"none", "hash", 1})));
  EXPECT_TRUE(absl::IsNotFound(store_->add_plan_run("anna", "none", {"s1", "hash", 1})));
  const auto runs = store_->list_plan_runs("anna", "q");
  ASSERT_EQ(runs->size(), 2u);
  EXPECT_EQ((*runs)[0].simulation, "s2") << "the newest first";
  EXPECT_EQ((*runs)[1].content_hash, "later") << "fat was added to it since";
  EXPECT_EQ((*runs)[1].create_time_us, 1);
  ASSERT_TRUE(store_->delete_simulation("s2").ok());
  EXPECT_EQ(store_->list_plan_runs("anna", "q")->size(), 1u);
  ASSERT_TRUE(store_->delete_plan("anna", "q").ok());
  EXPECT_TRUE(store_->get_simulation("s1").ok()) << "what was run stays";
  EXPECT_TRUE(store_->add_plan_run("anna", "r", {"s1", "hash", 1}).ok()) << "and is nobody's any more";
}

TEST_F(PlansTest, GoWithTheirPatientAndHoldItUntilThen) {
  ASSERT_TRUE(store_->create_plan(plan("q"), {}).ok());
  ASSERT_TRUE(store_->delete_scan("anna", "face-of-anna").ok());
  const absl::Status refused = store_->delete_patient("anna", false);
  EXPECT_TRUE(absl::IsFailedPrecondition(refused));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("0 scans and 0 models and 1 plans"));
  const auto veto = [](const PlanRecord& present) { return absl::AbortedError(present.content_message); };
  EXPECT_EQ(store_->delete_plan("anna", "q", veto), absl::AbortedError("first"));
  ASSERT_TRUE(store_->delete_patient("anna", true).ok());
  EXPECT_TRUE(absl::IsNotFound(store_->get_plan("anna", "q").status()));
  store_ = nullptr;
  const auto found = verify_store(directory_.path(), directory_.file("lipofill.sqlite"), [](const Verification&) {});
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->records, 2u) << "berta and her scan";
}

}  // namespace
}  // namespace lipofill::server
