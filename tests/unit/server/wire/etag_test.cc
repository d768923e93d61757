#include "server/wire/etag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/field_violations.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

TEST(Etag, OfAPatientFollowsNameAndLabels) {
  PatientRecord patient{"anna", "a-1", {{"arm", "b"}, {"side", "left"}}, 42};
  const std::string etag = make_etag(patient);
  EXPECT_EQ(etag.size(), 16u);
  PatientRecord other = patient;
  other.id = "berta";
  other.create_time_us = 43;
  EXPECT_EQ(make_etag(other), etag) << "of the content alone";
  other.display_name = "a-2";
  EXPECT_NE(make_etag(other), etag);
  other = patient;
  other.labels = {{"arm", "bs"}, {"ide", "left"}};
  EXPECT_NE(make_etag(other), etag) << "a label does not run over into the next";
  other.labels.clear();
  EXPECT_NE(make_etag(other), etag);
}

TEST(Etag, OfASimulationFollowsStateAndCommands) {
  SimulationRecord simulation;
  simulation.last_command = 3;
  simulation.state = SimulationState::kRunning;
  const std::string etag = make_etag(simulation);
  simulation.summary_message = "figures";
  EXPECT_EQ(make_etag(simulation), etag) << "steps change nothing that a client gave";
  simulation.last_command = 4;
  EXPECT_NE(make_etag(simulation), etag);
  simulation.last_command = 3;
  simulation.state = SimulationState::kPaused;
  EXPECT_NE(make_etag(simulation), etag);
}

TEST(Etag, IsCheckedOnlyWhereOneIsGiven) {
  EXPECT_TRUE(check_etag("", "present", "etag").ok());
  EXPECT_TRUE(check_etag("present", "present", "etag").ok());
  const absl::Status stale = check_etag("earlier", "present", "etag");
  EXPECT_TRUE(absl::IsAborted(stale));
  ASSERT_EQ(field_violations_of(stale).size(), 1u);
  EXPECT_EQ(field_violations_of(stale)[0].field, "etag");
  EXPECT_THAT(field_violations_of(stale)[0].description, HasSubstr("is \"earlier\", the present one is \"present\""));
}

TEST(Etag, ALongOneIsNotRepeatedInFull) {
  const absl::Status stale = check_etag(std::string(100'000, 'x'), "present", "patient.etag");
  EXPECT_LT(stale.ToString().size(), 1000u);
  EXPECT_EQ(field_violations_of(stale)[0].field, "patient.etag");
}

}  // namespace
}  // namespace lipofill::server
