#include "server/security/certificate_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

std::string refusal(const std::string& entry) {
  const auto map = CertificateMap::parse(R"({"certificates": [)" + entry + "]}");
  return map.ok() ? "" : std::string(map.status().message());
}

TEST(CertificateMap, FindsHoldersByTheirNames) {
  const auto map = CertificateMap::parse(R"({"certificates": [
    {"common_name": "planner-3", "tenant": "ward", "roles": ["planner"]},
    {"alternative_name": "wall.ward.example", "tenant": "ward", "roles": ["viewer"], "patients": ["ward-a"]},
    {"common_name": "planner-3", "tenant": "clinic", "roles": ["admin"]}]})");
  ASSERT_TRUE(map.ok()) << map.status();
  const Principal* planner = map->find({"planner-3"}, {"x.example"});
  ASSERT_NE(planner, nullptr);
  EXPECT_EQ(planner->scope.tenant, "ward") << "the first of two";
  EXPECT_EQ(planner->role, Role::kPlanner);
  EXPECT_EQ(planner->subject, "planner-3");
  EXPECT_FALSE(planner->expires.has_value());
  const Principal* wall = map->find({"somebody"}, {"other.example", "wall.ward.example"});
  ASSERT_NE(wall, nullptr);
  EXPECT_EQ(wall->role, Role::kViewer);
  EXPECT_TRUE(wall->scope.has("ward", "ward-a"));
  EXPECT_FALSE(wall->scope.has("ward", "ward-b"));
}

TEST(CertificateMap, TakesNamesWholeAndOnlyWhereTheyStand) {
  const auto map = CertificateMap::parse(
      R"({"certificates": [{"common_name": "planner", "tenant": "ward", "roles": ["planner"]}]})");
  ASSERT_TRUE(map.ok());
  EXPECT_EQ(map->find({"planner-3"}, {}), nullptr);
  EXPECT_EQ(map->find({"Planner"}, {}), nullptr);
  EXPECT_EQ(map->find({}, {"planner"}), nullptr) << "who chooses alternative names does not choose the common one";
  EXPECT_EQ(map->find({std::string("planner\0x", 9)}, {}), nullptr);
  EXPECT_EQ(map->find({}, {}), nullptr);
}

TEST(CertificateMap, EveryMistakeIsNamed) {
  EXPECT_EQ(refusal(R"({"common_name": "a", "tenant": "w", "roles": ["viewer"]})"), "");
  EXPECT_THAT(refusal("7"), HasSubstr("certificates[0]: must be an object"));
  EXPECT_THAT(refusal(R"({"tenant": "w", "roles": ["viewer"]})"), HasSubstr("either a common_name or an alternative"));
  EXPECT_THAT(refusal(R"({"common_name": "", "tenant": "w", "roles": ["viewer"]})"),
              HasSubstr("a name that is a text"));
  EXPECT_THAT(refusal(R"({"common_name": "a", "tenant": "W", "roles": ["viewer"]})"), HasSubstr("tenant must match"));
  EXPECT_THAT(refusal(R"({"common_name": "a", "tenant": "w"})"), HasSubstr("roles must be a list"));
  EXPECT_THAT(refusal(R"({"common_name": "a", "tenant": "w", "roles": ["root"]})"), HasSubstr("one of viewer"));
  EXPECT_THAT(refusal(R"({"common_name": "a", "tenant": "w", "roles": ["viewer"], "patient": ["x"]})"),
              HasSubstr("unknown member \"patient\""));
  EXPECT_FALSE(CertificateMap::parse("{").ok());
  EXPECT_FALSE(CertificateMap::parse("[]").ok());
}

}  // namespace
}  // namespace lipofill::server
