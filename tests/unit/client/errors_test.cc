#include "client/cpp/errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <nlohmann/json.hpp>

#include "client/cpp/connection.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

google::rpc::Status refused() {
  google::rpc::Status wire;
  wire.set_code(static_cast<int>(grpc::StatusCode::INVALID_ARGUMENT));
  wire.set_message("the plan is refused");
  google::rpc::ErrorInfo info;
  info.set_reason("FIELD_OUT_OF_RANGE");
  (*info.mutable_metadata())["bound"] = "0.5";
  wire.add_details()->PackFrom(info);
  google::rpc::BadRequest bad_request;
  auto* violation = bad_request.add_field_violations();
  violation->set_field("layers[0].poisson_ratio");
  violation->set_description("0.6 is not in [0, 0.5)");
  wire.add_details()->PackFrom(bad_request);
  return wire;
}

TEST(Errors, ReadsDetailsFromTheTrailingStatus) {
  const grpc::Status on_the_wire(grpc::StatusCode::INVALID_ARGUMENT, "the plan is refused",
                                 refused().SerializeAsString());
  const absl::Status status = status_of(on_the_wire, "a:1");
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  const ErrorDetails details = error_details_of(status);
  EXPECT_EQ(details.reason, "FIELD_OUT_OF_RANGE");
  EXPECT_EQ(details.metadata.at("bound"), "0.5");
  ASSERT_EQ(details.violations.size(), 1u);
  EXPECT_EQ(details.violations[0].field, "layers[0].poisson_ratio");
  EXPECT_THAT(error_text(status), HasSubstr("layers[0].poisson_ratio: 0.6 is not in [0, 0.5)"));
}

TEST(Errors, JsonNamesCodeAndFields) {
  const auto json = nlohmann::json::parse(error_json(status_of(refused())));
  EXPECT_EQ(json["error"]["code"], "INVALID_ARGUMENT");
  EXPECT_EQ(json["error"]["field_violations"][0]["field"], "layers[0].poisson_ratio");
  const auto plain = nlohmann::json::parse(error_json(absl::NotFoundError("no \xff such thing")));
  EXPECT_EQ(plain["error"]["code"], "NOT_FOUND");
  EXPECT_TRUE(plain["error"]["field_violations"].empty());
}

TEST(Errors, DetailsThatAreNoStatusAreIgnored) {
  const absl::Status status =
      status_of(grpc::Status(grpc::StatusCode::INTERNAL, "broken", "not a message \xff\x01"), "a:1");
  EXPECT_EQ(status.code(), absl::StatusCode::kInternal);
  EXPECT_EQ(error_text(status), "broken");
  EXPECT_TRUE(status_of(grpc::Status::OK, "a:1").ok());
}

TEST(Errors, NoDaemonSaysWhatToDo) {
  // Port 1 of the loopback interface: nothing listens there, and the kernel says so at once.
  const auto patient = Connection("127.0.0.1:1")
                           .call<v1::PatientService>(&v1::PatientService::Stub::GetPatient, v1::GetPatientRequest());
  EXPECT_EQ(patient.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(error_text(patient.status()),
              HasSubstr("no daemon answers at 127.0.0.1:1; start lipofilld or use --spawn"));
}

TEST(Errors, StopEndsACall) {
  std::stop_source stop;
  stop.request_stop();
  const auto patient = Connection("127.0.0.1:1", stop.get_token())
                           .call<v1::PatientService>(&v1::PatientService::Stub::GetPatient, v1::GetPatientRequest());
  EXPECT_EQ(patient.status().code(), absl::StatusCode::kCancelled);
}

TEST(Errors, ServerComesFromTheEnvironment) {
  ASSERT_EQ(setenv("LIPOFILL_SERVER", "far:7", 1), 0);
  EXPECT_EQ(default_server(), "far:7");
  ASSERT_EQ(unsetenv("LIPOFILL_SERVER"), 0);
  EXPECT_EQ(default_server(), "127.0.0.1:50061");
}

}  // namespace
}  // namespace lipofill::client
