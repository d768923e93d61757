// Plans that are kept, over the network: two clients and one etag, what a plan may name, pages,
// history, runs, and the end of the daemon.

#include "absl/strings/str_cat.h"
#include "lipofill/v1/plan_service.grpc.pb.h"
#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
using Plans = v1::PlanService::Stub;

class PlansTest : public RunTest {
 protected:
  PlansTest() { reconnect(); }
  void reconnect() { plans_ = v1::PlanService::NewStub(channel_); }

  static v1::SavedPlan draft(double volume_ml = 1.0) {
    auto plan = parse_text<v1::SavedPlan>(
        "title: 'left-cheek' side: LEFT_SIDE content { name: 'cheek' simulation { injections { zone: 'malar' } } }");
    plan.mutable_content()->mutable_simulation()->mutable_injections(0)->set_volume_ml(volume_ml);
    return plan;
  }
  grpc::Status try_create(const v1::SavedPlan& plan, v1::SavedPlan& made, const std::string& id = "",
                          const std::string& request_id = "", const std::string& patient = "patients/anna") {
    v1::CreatePlanRequest request;
    request.set_parent(patient);
    request.set_plan_id(id);
    request.set_request_id(request_id);
    *request.mutable_plan() = plan;
    return call(*plans_, &Plans::CreatePlan, request, made);
  }
  v1::SavedPlan create_plan(const std::string& id = "q", const v1::SavedPlan& plan = draft()) {
    v1::SavedPlan made;
    const grpc::Status status = try_create(plan, made, id);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return made;
  }
  grpc::Status update(const v1::SavedPlan& plan, v1::SavedPlan& made, const std::string& mask = "") {
    v1::UpdatePlanRequest request;
    *request.mutable_plan() = plan;
    if (!mask.empty()) request.mutable_update_mask()->add_paths(mask);
    return call(*plans_, &Plans::UpdatePlan, request, made);
  }
  grpc::Status get(const std::string& name, v1::SavedPlan& plan) {
    v1::GetPlanRequest request;
    request.set_name(name);
    return call(*plans_, &Plans::GetPlan, request, plan);
  }
  v1::ListPlanRevisionsResponse revisions(const std::string& name, int page_size = 0, const std::string& token = "") {
    v1::ListPlanRevisionsRequest request;
    request.set_parent(name);
    request.set_page_size(page_size);
    request.set_page_token(token);
    v1::ListPlanRevisionsResponse response;
    EXPECT_TRUE(call(*plans_, &Plans::ListPlanRevisions, request, response).ok());
    return response;
  }
  static void set_volume(v1::SavedPlan& plan, double volume_ml) {
    plan.mutable_content()->mutable_simulation()->mutable_injections(0)->set_volume_ml(volume_ml);
  }

  std::unique_ptr<Plans> plans_;
};

TEST_F(PlansTest, TheLaterOfTwoEditsIsToldWhatChanged) {
  const v1::SavedPlan read = create_plan();
  EXPECT_EQ(read.name(), "patients/anna/plans/q");
  EXPECT_EQ(read.revision(), 1u);
  v1::SavedPlan hers = read, his = read, answer;
  set_volume(hers, 2.0);
  hers.set_title("less");
  ASSERT_TRUE(update(hers, answer).ok());
  EXPECT_EQ(answer.revision(), 2u);
  EXPECT_NE(answer.content_hash(), read.content_hash());

  set_volume(his, 3.0);
  const grpc::Status late = update(his, answer);
  EXPECT_EQ(late.error_code(), grpc::StatusCode::ABORTED);
  const auto told = violations_of(late);
  EXPECT_THAT(told.at("plan.etag"), HasSubstr("it was changed at 20"));
  EXPECT_EQ(told.at("plan.title"), "was \"left-cheek\", is \"less\"");
  EXPECT_EQ(told.at("plan.content.simulation.injections[0].volume_ml"), "was 1, is 2");
  EXPECT_EQ(told.size(), 3u) << late.error_message();

  v1::SavedPlan present;
  ASSERT_TRUE(get("patients/anna/plans/q", present).ok());
  EXPECT_EQ(present.title(), "less");
  ASSERT_TRUE(update(hers, answer).ok()) << "what is there already is done, to repeat it does no harm";
  EXPECT_EQ(answer.etag(), present.etag());
  his.set_etag(present.etag());
  ASSERT_TRUE(update(his, answer, "content").ok());
  EXPECT_EQ(answer.title(), "less") << "the mask leaves it";
  EXPECT_EQ(answer.content().simulation().injections(0).volume_ml(), 3.0);
}

TEST_F(PlansTest, WhatWasAcknowledgedIsThereAfterAHardDeath) {
  v1::SavedPlan plan = create_plan();
  const int edits = 40;
  for (int i = 1; i <= edits; ++i) {
    set_volume(plan, i);
    const grpc::Status status = update(plan, plan);
    ASSERT_TRUE(status.ok()) << status.error_message();
    if (i % 10 == 0) {
      restart_hard();
      reconnect();
      v1::SavedPlan found;
      ASSERT_TRUE(get(plan.name(), found).ok());
      EXPECT_EQ(found.SerializeAsString(), plan.SerializeAsString());
    }
  }
  const auto history = revisions(plan.name());
  EXPECT_EQ(history.revisions_size(), edits) << "the first edit made the plan what it was";
}

TEST_F(PlansTest, HistoryTellsWhatChangedAndGivesItBack) {
  v1::SavedPlan plan = create_plan();
  for (const double volume_ml : {2.0, 3.0}) {
    set_volume(plan, volume_ml);
    ASSERT_TRUE(update(plan, plan).ok());
  }
  const auto first = revisions(plan.name(), 2);
  ASSERT_EQ(first.revisions_size(), 2);
  EXPECT_EQ(first.revisions(0).revision(), 3u);
  EXPECT_THAT(first.revisions(0).changes(), ElementsAre("content.simulation.injections[0].volume_ml was 2, is 3"));
  EXPECT_GT(first.revisions(0).size_bytes(), 0u);
  const auto second = revisions(plan.name(), 2, first.next_page_token());
  ASSERT_EQ(second.revisions_size(), 1);
  EXPECT_EQ(second.revisions(0).revision(), 1u);
  EXPECT_EQ(second.next_page_token(), "");

  v1::GetPlanRevisionRequest request;
  request.set_name(plan.name());
  request.set_revision(1);
  v1::SavedPlan earlier, back;
  ASSERT_TRUE(call(*plans_, &Plans::GetPlanRevision, request, earlier).ok());
  EXPECT_EQ(earlier.content().simulation().injections(0).volume_ml(), 1.0);
  earlier.set_etag(plan.etag());
  ASSERT_TRUE(update(earlier, back).ok());
  EXPECT_EQ(back.revision(), 4u) << "to go back is a change too";
  EXPECT_EQ(back.content_hash(), earlier.content_hash());
  request.set_revision(9);
  const grpc::Status none = call(*plans_, &Plans::GetPlanRevision, request, earlier);
  EXPECT_EQ(none.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(none.error_message(), HasSubstr("those from 1 to 4 are kept"));
}

TEST_F(PlansTest, NameNothingOfAnotherPatient) {
  create_patient("berta");
  const v1::Scan annas = create_scan("patients/anna", v1::OBJ, sheet_obj());
  const v1::Scan bertas = create_scan("patients/berta", v1::OBJ, sheet_obj());
  v1::SavedPlan made;
  const auto refused = [&](const v1::SavedPlan& plan, const std::string& field) {
    const grpc::Status status = try_create(plan, made);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << field;
    EXPECT_EQ(violations_of(status).count(field), 1u) << field << ": " << status.error_message();
  };
  v1::SavedPlan plan = draft();
  plan.set_scan(bertas.name());
  refused(plan, "plan.scan");
  plan.set_scan(annas.name());
  plan.set_target_scan(bertas.name());
  refused(plan, "plan.target_scan");
  plan.clear_target_scan();
  plan.mutable_content()->mutable_model()->mutable_scan_region()->set_bone_scan(bertas.name());
  refused(plan, "plan.content");
  plan = draft();
  plan.mutable_content()->mutable_simulation()->set_model("patients/berta/models/m");
  refused(plan, "plan.content");
  plan = draft();
  plan.mutable_content()->mutable_model()->mutable_scan_region()->set_scan(annas.name());
  refused(plan, "plan.content.model.scan_region.scan");
  plan = draft();
  plan.mutable_content()->mutable_scan()->set_file("/home/me/Erika.obj");
  refused(plan, "plan.content.scan");
  plan = draft();
  plan.mutable_content()->set_description(std::string((1 << 20) + 1, 'x'));
  refused(plan, "plan.content");
}

TEST_F(PlansTest, LandmarksDoNotFollowToAnotherScan) {
  const v1::Scan first = create_scan("patients/anna", v1::OBJ, sheet_obj());
  const v1::Scan second = create_scan("patients/anna", v1::OBJ, sheet_obj(12, 8.0));
  v1::SavedPlan plan = draft();
  plan.set_scan(first.name());
  auto& landmarks = *plan.mutable_content()->mutable_model()->mutable_scan_region()->mutable_landmarks_mm();
  landmarks["nasion"].set_x(1.0);
  plan = create_plan("q", plan);
  v1::SavedPlan moved = plan, answer;
  moved.set_scan(second.name());
  const grpc::Status status = update(moved, answer);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(violations_of(status), ElementsAre(Pair("plan.content.model.scan_region.landmarks_mm[nasion]",
                                                      HasSubstr("must be placed on " + second.name()))));
  (*moved.mutable_content()->mutable_model()->mutable_scan_region()->mutable_landmarks_mm())["nasion"].set_x(1.5);
  EXPECT_TRUE(update(moved, answer).ok());
}

TEST_F(PlansTest, KnowTheirRunsAndWhetherTheyChangedSince) {
  v1::SavedPlan plan = create_plan();
  create(0.05, "x", false);
  v1::AddPlanRunRequest request;
  request.set_name(plan.name());
  request.set_simulation("simulations/x");
  v1::SavedPlan answer;
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(call(*plans_, &Plans::AddPlanRun, request, answer).ok());
    ASSERT_EQ(answer.runs_size(), 1);
    EXPECT_EQ(answer.runs(0).simulation(), "simulations/x");
    EXPECT_EQ(answer.runs(0).content_hash(), plan.content_hash());
    EXPECT_EQ(answer.etag(), plan.etag()) << "nobody's edit is late because of a run";
  }
  v1::SavedPlan renamed = plan;
  renamed.set_title("other");
  renamed.mutable_content()->set_description("words");
  ASSERT_TRUE(update(renamed, renamed).ok());
  EXPECT_EQ(renamed.content_hash(), renamed.runs(0).content_hash()) << "words do not change what is simulated";
  set_volume(renamed, 7.0);
  ASSERT_TRUE(update(renamed, renamed).ok());
  EXPECT_NE(renamed.content_hash(), renamed.runs(0).content_hash());

  create_plan("other");
  request.set_name("patients/anna/plans/other");
  EXPECT_EQ(call(*plans_, &Plans::AddPlanRun, request, answer).error_code(), grpc::StatusCode::ALREADY_EXISTS);
  create_patient("berta");
  ASSERT_TRUE(try_create(draft(), answer, "hers", "", "patients/berta").ok());
  request.set_name("patients/berta/plans/hers");
  const grpc::Status refused = call(*plans_, &Plans::AddPlanRun, request, answer);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(violations_of(refused).at("simulation"), HasSubstr("must be a simulation of patients/berta"));
}

TEST_F(PlansTest, AreListedOfOnePatientAndOfAllAndGoWithThem) {
  create_patient("berta");
  v1::SavedPlan made;
  for (const char* id : {"a", "b", "c"}) create_plan(id);
  ASSERT_TRUE(try_create(draft(), made, "d", "", "patients/berta").ok());
  const auto names = [&](const std::string& parent, int page_size) {
    std::vector<std::string> found;
    v1::ListPlansRequest request;
    request.set_parent(parent);
    request.set_page_size(page_size);
    request.mutable_read_mask()->add_paths("name");
    do {
      v1::ListPlansResponse response;
      const grpc::Status status = call(*plans_, &Plans::ListPlans, request, response);
      EXPECT_TRUE(status.ok()) << status.error_message();
      EXPECT_LE(response.plans_size(), page_size);
      for (const auto& plan : response.plans()) {
        EXPECT_FALSE(plan.has_content());
        found.push_back(plan.name());
      }
      request.set_page_token(response.next_page_token());
    } while (!request.page_token().empty() && !HasFailure());
    return found;
  };
  EXPECT_THAT(names("patients/anna", 2),
              ElementsAre("patients/anna/plans/a", "patients/anna/plans/b", "patients/anna/plans/c"));
  EXPECT_THAT(names("patients/-", 3), ElementsAre("patients/anna/plans/a", "patients/anna/plans/b",
                                                  "patients/anna/plans/c", "patients/berta/plans/d"));

  google::protobuf::Empty nothing;
  v1::DeletePatientRequest request;
  request.set_name("patients/berta");
  const grpc::Status held = call(*patients_, &v1::PatientService::Stub::DeletePatient, request, nothing);
  EXPECT_EQ(held.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(held.error_message(), HasSubstr("1 plans"));
  request.set_force(true);
  ASSERT_TRUE(call(*patients_, &v1::PatientService::Stub::DeletePatient, request, nothing).ok());
  EXPECT_EQ(get("patients/berta/plans/d", made).error_code(), grpc::StatusCode::NOT_FOUND);
  v1::DeletePlanRequest one;
  one.set_name("patients/anna/plans/a");
  ASSERT_TRUE(call(*plans_, &Plans::DeletePlan, one, nothing).ok());
  EXPECT_EQ(names("patients/-", 9).size(), 2u);
}

TEST_F(PlansTest, PagesOfLargePlansStayBelowTheBoundOfAMessage) {
  v1::SavedPlan large = draft();
  large.mutable_content()->set_description(std::string(900'000, 'x'));
  for (int i = 0; i < 6; ++i) create_plan(absl::StrCat("q", i), large);
  v1::ListPlansRequest request;
  request.set_parent("patients/anna");
  int found = 0, pages = 0;
  do {
    v1::ListPlansResponse response;
    const grpc::Status status = call(*plans_, &Plans::ListPlans, request, response);
    ASSERT_TRUE(status.ok()) << status.error_message();
    found += response.plans_size();
    ++pages;
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  EXPECT_EQ(found, 6);
  EXPECT_GT(pages, 1);
}

TEST_F(PlansTest, OneRequestMakesOnePlanAndAValidatedOneMakesNone) {
  v1::SavedPlan first, again;
  ASSERT_TRUE(try_create(draft(), first, "", "r1").ok());
  ASSERT_TRUE(try_create(draft(), again, "", "r1").ok());
  EXPECT_EQ(first.name(), again.name());
  v1::CreatePlanRequest request;
  request.set_parent("patients/anna");
  request.set_plan_id("draft");
  request.set_validate_only(true);
  *request.mutable_plan() = draft();
  ASSERT_TRUE(call(*plans_, &Plans::CreatePlan, request, again).ok());
  EXPECT_EQ(again.content_hash(), first.content_hash());
  EXPECT_EQ(get("patients/anna/plans/draft", again).error_code(), grpc::StatusCode::NOT_FOUND);
  v1::UpdatePlanRequest change;
  *change.mutable_plan() = first;
  change.mutable_plan()->set_title("another");
  change.set_validate_only(true);
  ASSERT_TRUE(call(*plans_, &Plans::UpdatePlan, change, again).ok());
  EXPECT_EQ(again.title(), "another");
  ASSERT_TRUE(get(first.name(), again).ok());
  EXPECT_EQ(again.title(), "left-cheek");
}

}  // namespace
}  // namespace lipofill::testing
