#include "server/entry/call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lipofill/v1/frame_service.pb.h"
#include "lipofill/v1/operation_service.pb.h"
#include "lipofill/v1/patient_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/entry/method_rules.h"

namespace lipofill::server {
namespace {

using ::testing::MatchesRegex;

constexpr char kTraceParent[] = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";

Call read(const std::string& request_id, const std::string& trace_parent) {
  Metadata metadata;
  metadata.emplace("x-request-id", request_id);
  metadata.emplace("traceparent", trace_parent);
  return read_call("/a/B", metadata);
}

TEST(Call, CarriesTheIdsOfItsClient) {
  const Call call = read("Order-66:a.b_c", kTraceParent);
  EXPECT_EQ(call.method, "/a/B");
  EXPECT_EQ(call.request_id, "Order-66:a.b_c");
  EXPECT_EQ(call.trace_id, "4bf92f3577b34da6a3ce929d0e0e4736");
  EXPECT_EQ(call.parent_id, "00f067aa0ba902b7");
  EXPECT_EQ(call.log_fields().size(), 3u);
}

TEST(Call, IsGivenAnIdWithoutAProperOne) {
  const std::string made = read_call("/a/B", {}).request_id;
  EXPECT_THAT(made, MatchesRegex("r[0-9a-f]{16}"));
  EXPECT_NE(made, read_call("/a/B", {}).request_id);
  for (const std::string& bad : {std::string(), std::string("two words"), std::string("line\nbreak"),
                                 std::string("M\xc3\xbcller"), std::string(65, 'x')}) {
    EXPECT_THAT(read(bad, "").request_id, MatchesRegex("r[0-9a-f]{16}")) << bad;
  }
}

TEST(Call, TakesOnlyWholeTraceParents) {
  for (const char* bad : {"", "00", "01-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01",
                          "00-00000000000000000000000000000000-00f067aa0ba902b7-01",
                          "00-4bf92f3577b34da6a3ce929d0e0e4736-0000000000000000-01",
                          "00-4BF92F3577B34DA6A3CE929D0E0E4736-00f067aa0ba902b7-01", "00-4bf92f35-00f067aa0ba902b7-01",
                          "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01-more"}) {
    EXPECT_EQ(read("", bad).trace_id, "") << bad;
  }
  EXPECT_EQ(read("", "").log_fields().size(), 1u);
}

TEST(MethodRules, KnowEveryMethodOfEveryService) {
  for (const google::protobuf::FileDescriptor* file :
       {v1::WatchRequest::descriptor()->file(), v1::GetOperationRequest::descriptor()->file(),
        v1::GetPatientRequest::descriptor()->file(), v1::GetSimulationRequest::descriptor()->file()}) {
    ASSERT_EQ(file->service_count(), 1);
    const auto* service = file->service(0);
    for (int i = 0; i < service->method_count(); ++i) {
      const std::string method = "/" + service->full_name() + "/" + service->method(i)->name();
      ASSERT_TRUE(has_rule(method)) << method << " is not in server/entry/method_rules.cc";
      const std::string& name = service->method(i)->name();
      const MethodRule& rule = *rule_of(method);
      EXPECT_FALSE(rule.is_open || rule.least < Role::kViewer) << method << " must ask who calls";
      EXPECT_TRUE(name.rfind("Get", 0) != 0 || rule.effect == Effect::kNone) << method;
      EXPECT_TRUE(name.rfind("Create", 0) != 0 || rule.effect == Effect::kBegins) << method;
    }
  }
  EXPECT_TRUE(has_rule("/grpc.health.v1.Health/Check"));
  EXPECT_FALSE(has_rule("/lipofill.v1.PatientService/NoSuchMethod"));
}

}  // namespace
}  // namespace lipofill::server
