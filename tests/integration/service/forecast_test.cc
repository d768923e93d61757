// Forecasts over the network: an operation whose answer is the same whatever the daemon, with
// inputs that can be looked at before; retention; what is refused.

#include "lipofill/v1/forecast_service.grpc.pb.h"
#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Key;
using ::testing::UnorderedElementsAre;

class ForecastTest : public RunTest {
 protected:
  ForecastTest() : forecasts_(v1::ForecastService::NewStub(channel_)) {}

  v1::MakeForecastRequest make_request() {
    v1::MakeForecastRequest request;
    request.set_parent("patients/anna");
    *request.mutable_spec()->mutable_plan() = square_plan(model_.name(), 10.0);
    request.mutable_spec()->set_members(60);
    request.mutable_spec()->add_months(3.0);
    request.mutable_spec()->add_months(12.0);
    return request;
  }
  grpc::Status start(const v1::MakeForecastRequest& request, v1::Operation& operation) {
    return call(*forecasts_, &v1::ForecastService::Stub::MakeForecast, request, operation);
  }
  v1::Operation finish(const v1::MakeForecastRequest& request) {
    v1::Operation operation;
    const grpc::Status started = start(request, operation);
    EXPECT_TRUE(started.ok()) << started.error_message();
    return started.ok() ? await(operation) : operation;
  }
  v1::Forecast forecast(const v1::MakeForecastRequest& request) {
    const v1::Operation operation = finish(request);
    v1::Forecast made;
    EXPECT_TRUE(operation.response().UnpackTo(&made)) << operation.error().message();
    return made;
  }
  grpc::Status estimate(const v1::EstimateRetentionRequest& request, v1::RetentionEstimate& answer) {
    return call(*forecasts_, &v1::ForecastService::Stub::EstimateRetention, request, answer);
  }

  std::unique_ptr<v1::ForecastService::Stub> forecasts_;
};

TEST_F(ForecastTest, TellsFiguresBandsAndMonths) {
  const v1::Forecast made = forecast(make_request());
  EXPECT_EQ(made.members(), 60u);
  EXPECT_EQ(made.failed_members(), 0u);
  ASSERT_EQ(made.times_size(), 3);
  const auto vertices = static_cast<int>(made.times(0).lift_p05_mm_size());
  EXPECT_EQ(vertices, 81) << "8 x 8 quadrilaterals";
  EXPECT_EQ(made.times(2).mean_displacement_mm_size(), 3 * vertices);
  for (const v1::ForecastTime& time : made.times()) {
    for (const v1::ForecastFigure& figure : time.figures()) {
      EXPECT_LE(figure.p05(), figure.p50()) << figure.name();
      EXPECT_LE(figure.p50(), figure.p95()) << figure.name();
    }
    const v1::PressureBands& bands = time.bands(0);
    EXPECT_NEAR(bands.below_9_mmhg() + bands.from_9_to_15_mmhg() + bands.from_15_to_30_mmhg() + bands.above_30_mmhg(),
                1.0, 1e-12);
  }
  EXPECT_EQ(made.inputs(made.inputs_size() - 1).quantity(), v1::UncertainInput::RETENTION);
  EXPECT_GT(made.causes_size(), 0);
  ASSERT_EQ(made.zones_size(), 1);
  EXPECT_NEAR(made.zones(0).inject_ml() * made.retention().months(1).p50(), made.zones(0).wanted_ml(), 1e-9);
  EXPECT_EQ(made.retention().months_size(), 2);
}

TEST_F(ForecastTest, AnEqualRequestHasTheSameForecastAlsoAfterARestart) {
  v1::Forecast first = forecast(make_request());
  restart();
  forecasts_ = v1::ForecastService::NewStub(channel_);
  v1::Forecast again = forecast(make_request());
  first.clear_wall_s();
  again.clear_wall_s();
  EXPECT_EQ(first.SerializeAsString(), again.SerializeAsString());
}

TEST_F(ForecastTest, ShowsItsInputsBeforeAnythingIsSolved) {
  v1::MakeForecastRequest request = make_request();
  request.set_validate_only(true);
  v1::UncertainInput& input = *request.mutable_spec()->add_inputs();
  input.set_quantity(v1::UncertainInput::PLACE_XI);
  input.mutable_distribution()->set_law(v1::Distribution::UNIFORM);
  input.mutable_distribution()->set_low(-2.0);
  input.mutable_distribution()->set_high(2.0);
  v1::Operation operation;
  ASSERT_TRUE(start(request, operation).ok());
  EXPECT_EQ(operation.name(), "");
  v1::Forecast checked;
  ASSERT_TRUE(operation.response().UnpackTo(&checked));
  bool is_there = false;
  for (const v1::UncertainInput& told : checked.inputs()) {
    EXPECT_NE(told.source(), "") << told.ShortDebugString();
    is_there = is_there || (told.quantity() == v1::UncertainInput::PLACE_XI && told.distribution().low() == -2.0);
  }
  EXPECT_TRUE(is_there);
}

TEST_F(ForecastTest, RefusesWithFieldsAndFigures) {
  v1::MakeForecastRequest request = make_request();
  request.mutable_spec()->set_members(20'000);
  request.mutable_spec()->add_months(6.0);
  request.mutable_spec()->mutable_retention()->add_points()->set_month(3.0);
  request.mutable_spec()->mutable_retention()->mutable_points(0)->set_share(1.5);
  request.mutable_spec()->set_session_band_mmhg(0.0);
  request.mutable_spec()->mutable_follow_up()->set_month(3.0);
  v1::Operation operation;
  EXPECT_THAT(
      violations_of(start(request, operation)),
      ::testing::IsSupersetOf({Key("spec.members"), Key("spec.months[2]"), Key("spec.retention.points[0].share"),
                               Key("spec.session_band_mmhg"), Key("spec.follow_up")}));
  request = make_request();
  v1::UncertainInput& input = *request.mutable_spec()->add_inputs();
  input.set_quantity(v1::UncertainInput::LAYER_THICKNESS);
  input.set_name("skin");
  input.mutable_distribution()->set_law(v1::Distribution::NORMAL);
  input.mutable_distribution()->set_centre(1.0);
  input.mutable_distribution()->set_spread(0.5);
  EXPECT_THAT(violations_of(start(request, operation)), ::testing::Contains(Key("spec.inputs[0].distribution.low")));
  request = make_request();
  request.mutable_spec()->mutable_plan()->mutable_fat()->set_yield_stress_pa(20.0);
  operation = finish(request);
  EXPECT_EQ(operation.error().code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(operation.error().message(), HasSubstr("yield_stress"));
}

TEST_F(ForecastTest, EstimatesRetention) {
  v1::EstimateRetentionRequest request;
  request.set_wanted_ml(5.0);
  v1::RetentionEstimate prior, found;
  ASSERT_TRUE(estimate(request, prior).ok());
  ASSERT_EQ(prior.months_size(), 4);
  EXPECT_NEAR(prior.months(3).p50(), 0.47, 0.002);
  EXPECT_NEAR(prior.inject_ml(), 5.0 / prior.months(3).p50(), 1e-9);
  request.set_injected_ml(10.0);
  request.mutable_follow_up()->set_month(3.0);
  request.mutable_follow_up()->set_kept_ml(6.5);
  request.mutable_follow_up()->set_standard_error_ml(0.5);
  ASSERT_TRUE(estimate(request, found).ok());
  EXPECT_TRUE(found.updated());
  EXPECT_GT(found.months(3).p50(), prior.months(3).p50());
  EXPECT_LT(found.months(3).p95() - found.months(3).p05(), 0.5 * (prior.months(3).p95() - prior.months(3).p05()));
  request.mutable_follow_up()->set_kept_ml(20.0);
  EXPECT_THAT(violations_of(estimate(request, found)), UnorderedElementsAre(Key("follow_up")));
  request.clear_follow_up();
  request.set_injected_ml(-1.0);
  EXPECT_THAT(violations_of(estimate(request, found)), UnorderedElementsAre(Key("injected_ml")));
}

}  // namespace
}  // namespace lipofill::testing
