#include "server/wire/status_mapping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error_hints.h"
#include "core/base/field_violations.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "server/wire/violation_prefix.h"

namespace lipofill::server {
namespace {

google::rpc::Status details_of(const grpc::Status& status) {
  google::rpc::Status message;
  EXPECT_TRUE(message.ParseFromString(status.error_details()));
  return message;
}

TEST(StatusMapping, OkIsOk) {
  EXPECT_TRUE(to_grpc_status(absl::OkStatus()).ok());
}

TEST(StatusMapping, CarriesCodeMessageAndReason) {
  const grpc::Status status = to_grpc_status(absl::NotFoundError("there is no patients/x"));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(status.error_message(), "there is no patients/x");
  const google::rpc::Status details = details_of(status);
  EXPECT_EQ(details.code(), 5);
  google::rpc::ErrorInfo info;
  ASSERT_EQ(details.details_size(), 1);
  ASSERT_TRUE(details.details(0).UnpackTo(&info));
  EXPECT_EQ(info.domain(), "lipofill");
  EXPECT_EQ(info.reason(), "NOT_FOUND");
}

TEST(StatusMapping, SaysWhenToTryAgain) {
  const absl::Status drained = with_hints(absl::UnavailableError("later"), {"DRAINING", 2.5});
  const google::rpc::Status details = details_of(to_grpc_status(drained));
  ASSERT_EQ(details.details_size(), 2);
  google::rpc::ErrorInfo info;
  ASSERT_TRUE(details.details(0).UnpackTo(&info));
  EXPECT_EQ(info.reason(), "DRAINING");
  google::rpc::RetryInfo retry;
  ASSERT_TRUE(details.details(1).UnpackTo(&retry));
  EXPECT_EQ(retry.retry_delay().seconds(), 2);
  EXPECT_EQ(retry.retry_delay().nanos(), 500'000'000);
}

TEST(StatusMapping, CarriesFieldViolations) {
  FieldViolations violations;
  violations.check_range("fat.viscosity_pa_s", -1.0, 0.001, 1e4, "Pa s");
  violations.add("films[0].n_xi", "is missing");
  const google::rpc::Status details = details_of(to_grpc_status(with_prefix("spec", violations.to_status())));
  google::rpc::BadRequest bad;
  ASSERT_EQ(details.details_size(), 2);
  ASSERT_TRUE(details.details(1).UnpackTo(&bad));
  ASSERT_EQ(bad.field_violations_size(), 2);
  EXPECT_EQ(bad.field_violations(0).field(), "spec.fat.viscosity_pa_s");
  EXPECT_THAT(bad.field_violations(0).description(), ::testing::HasSubstr("-1 Pa s"));
  EXPECT_EQ(bad.field_violations(1).field(), "spec.films[0].n_xi");
}

TEST(StatusMapping, KeepsTheCodeOfAViolationThatIsNoBadArgument) {
  const absl::Status status = field_violation("injection", "too late", absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(to_grpc_status(with_prefix("a", status)).error_code(), grpc::StatusCode::FAILED_PRECONDITION);
}

TEST(StatusMapping, FitsIntoHeaders) {
  FieldViolations violations;
  for (int i = 0; i < 5000; ++i) violations.add("field", std::string(100, 'x'));
  const grpc::Status status = to_grpc_status(violations.to_status());
  EXPECT_LE(status.error_message().size() + status.error_details().size(), 7000u);
  EXPECT_GE(details_of(status).details_size(), 2);
}

}  // namespace
}  // namespace lipofill::server
