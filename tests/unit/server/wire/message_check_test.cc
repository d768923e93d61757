#include "server/wire/message_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/base/field_violations.h"
#include "lipofill/v1/patient_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

FieldViolation only_violation(const google::protobuf::Message& message) {
  const auto violations = field_violations_of(check_message(message));
  EXPECT_EQ(violations.size(), 1u) << check_message(message);
  return violations.empty() ? FieldViolation{} : violations[0];
}

TEST(MessageCheck, PassesAPlainMessage) {
  v1::CreateSimulationRequest request;
  request.mutable_spec()->add_films()->add_zones()->mutable_box()->set_xi_min(0.5);
  EXPECT_TRUE(check_message(request).ok());
}

TEST(MessageCheck, NamesTheMessageWithAnUnknownField) {
  v1::CreateSimulationRequest request;
  v1::Film* film = request.mutable_spec()->add_films();
  film->GetReflection()->MutableUnknownFields(film)->AddVarint(99, 1);
  const FieldViolation violation = only_violation(request);
  EXPECT_EQ(violation.field, "spec.films[0]");
  EXPECT_THAT(violation.description, HasSubstr("99"));
  EXPECT_THAT(violation.description, HasSubstr("lipofill.v1.Film"));
}

TEST(MessageCheck, LooksIntoMaps) {
  v1::BuildModelRequest request;
  auto& landmarks = *request.mutable_spec()->mutable_scan_region()->mutable_landmarks_mm();
  landmarks["nasion"].set_x(std::numeric_limits<double>::infinity());
  EXPECT_EQ(only_violation(request).field, "spec.scan_region.landmarks_mm[nasion].x");
}

TEST(MessageCheck, RefusesNumbersThatAreNotFinite) {
  v1::CreateSimulationRequest request;
  request.mutable_spec()->mutable_fat()->set_viscosity_pa_s(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(only_violation(request).field, "spec.fat.viscosity_pa_s");

  v1::BuildModelRequest build;
  auto* samples = build.mutable_spec()->add_layers()->mutable_thickness_mm()->mutable_samples();
  samples->add_values(1.0);
  samples->add_values(-std::numeric_limits<double>::infinity());
  EXPECT_EQ(only_violation(build).field, "spec.layers[0].thickness_mm.samples.values[1]");
}

TEST(MessageCheck, RefusesUnknownEnumerators) {
  v1::CreateSimulationRequest request;
  request.mutable_spec()->set_coupling(static_cast<v1::Coupling>(7));
  const FieldViolation violation = only_violation(request);
  EXPECT_EQ(violation.field, "spec.coupling");
  EXPECT_THAT(violation.description, HasSubstr("is 7"));
}

TEST(MessageCheck, BoundsWhatItTells) {
  v1::BuildModelRequest build;
  auto* samples = build.mutable_spec()->add_layers()->mutable_thickness_mm()->mutable_samples();
  for (int i = 0; i < 100'000; ++i) samples->add_values(std::numeric_limits<double>::quiet_NaN());
  EXPECT_LE(field_violations_of(check_message(build)).size(), 20u);
}

}  // namespace
}  // namespace lipofill::server
