// Settled shapes found at once: what a simulation of the plan comes to, from rest byte for byte,
// along a drag within the tolerance; nothing is kept; and what is refused.

#include <cmath>
#include <cstring>
#include <thread>

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

/// An answer of FindShape, put together.
struct SeenShape {
  v1::FoundShape shape;
  std::map<std::string, std::string> bytes;  ///< of the fields
  grpc::Status status;
};

std::vector<float> floats_of(const std::string& bytes) {
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

double largest_difference(const std::string& a, const std::string& b) {
  const std::vector<float> left = floats_of(a), right = floats_of(b);
  EXPECT_EQ(left.size(), right.size());
  double largest = 0.0;
  for (size_t k = 0; k < std::min(left.size(), right.size()); ++k) {
    largest = std::max(largest, std::abs(static_cast<double>(left[k]) - right[k]));
  }
  return largest;
}

class ShapeTest : public RunTest {
 protected:
  /// Solved directly by a simulation as well.
  v1::SimulationSpec plan() const {
    v1::SimulationSpec spec = square_plan(model_.name(), 600.0);
    spec.clear_time();
    spec.mutable_time()->set_goal(v1::TimeControl::SETTLED_SHAPE);
    return spec;
  }
  SeenShape find(const v1::FindShapeRequest& request) {
    SeenShape seen;
    Context context;
    const auto stream = simulations_->FindShape(&context, request);
    v1::FindShapeResponse response;
    while (stream->Read(&response)) {
      if (response.has_shape()) seen.shape = response.shape();
      for (const v1::ArraySlice& array : response.frame().fields()) seen.bytes[array.name()] += array.data();
    }
    seen.status = stream->Finish();
    return seen;
  }
  v1::FindShapeRequest request(double volume_ml, const std::string& drag = "") const {
    v1::FindShapeRequest request;
    *request.mutable_spec() = plan();
    request.set_drag(drag);
    v1::InjectionVolume& volume = *request.add_injections();
    volume.set_volume_ml(volume_ml);
    return request;
  }
  /// The simulation of the plan with this volume, ended.
  v1::Simulation run(double volume_ml, const std::string& id) {
    v1::SimulationSpec spec = plan();
    spec.mutable_injections(0)->set_volume_ml(volume_ml);
    v1::Simulation simulation;
    const grpc::Status created = create_simulation(spec, id, true, simulation);
    EXPECT_TRUE(created.ok()) << created.error_message();
    return await_end("simulations/" + id);
  }
  std::string skin_of(const std::string& name) {
    Watcher watcher(*channel_, watch_request(name, v1::WatchRequest::LATEST));
    SeenFrame last;
    watcher.drain(&last);
    return last.bytes["skin.displacement"];
  }
};

TEST_F(ShapeTest, FromRestItIsTheShapeOfASimulationByteForByte) {
  const v1::Simulation simulation = run(0.2, "x");
  ASSERT_EQ(simulation.state(), v1::Simulation::SETTLED) << simulation.reason();
  const SeenShape seen = find(request(0.2));
  ASSERT_TRUE(seen.status.ok()) << seen.status.error_message();
  EXPECT_EQ(seen.shape.summary().state_hash(), simulation.summary().state_hash());
  EXPECT_EQ(seen.bytes.at("skin.displacement"), skin_of("simulations/x"));
  EXPECT_EQ(seen.shape.summary().max_pressure_pa(), simulation.summary().max_pressure_pa());
  EXPECT_EQ(seen.shape.volume_share(), 1.0);
  EXPECT_TRUE(seen.shape.from_rest());
  ASSERT_EQ(seen.shape.pools_size(), 1);
  EXPECT_NEAR(seen.shape.pools(0).volume_ml(), simulation.summary().film_volume_ml(), 1e-9);
  EXPECT_EQ(seen.shape.summary().zones_size(), simulation.summary().zones_size());
}

TEST_F(ShapeTest, ADragFollowsAndItsReleaseIsExact) {
  const std::string before = store_content();
  for (const double volume : {0.1, 0.14, 0.18, 0.2}) {
    const SeenShape seen = find(request(volume, "drag"));
    ASSERT_TRUE(seen.status.ok()) << seen.status.error_message();
    EXPECT_EQ(seen.shape.from_rest(), volume == 0.1);
    EXPECT_EQ(seen.shape.preparing_ms() > 1.0, volume == 0.1) << "the equations are at hand after the first";
  }
  const SeenShape followed = find(request(0.2, "drag"));
  v1::FindShapeRequest released = request(0.2, "drag");
  released.set_from_rest(true);
  const SeenShape exact = find(released);
  EXPECT_LT(largest_difference(followed.bytes.at("skin.displacement"), exact.bytes.at("skin.displacement")), 0.003);
  EXPECT_TRUE(followed.shape.summary().state_hash().empty()) << "it depends on the way";
  EXPECT_EQ(exact.shape.summary().state_hash(), find(request(0.2)).shape.summary().state_hash());
  EXPECT_EQ(store_content(), before) << "nothing of a drag is kept";
}

TEST_F(ShapeTest, FieldsComeAsAskedFor) {
  v1::FindShapeRequest wanted = request(0.2);
  wanted.add_fields("skin.thickness");
  wanted.set_field_type(v1::UINT16);
  const SeenShape seen = find(wanted);
  ASSERT_TRUE(seen.status.ok()) << seen.status.error_message();
  ASSERT_EQ(seen.bytes.size(), 1u);
  const size_t points = find(request(0.2)).bytes.at("skin.displacement").size() / (3 * sizeof(float));
  EXPECT_EQ(seen.bytes.at("skin.thickness").size(), points * sizeof(uint16_t));
  wanted.add_fields("skin.colour");
  EXPECT_TRUE(violations_of(find(wanted).status).contains("fields[1]"));
}

TEST_F(ShapeTest, SensitivitiesSayWhatALittleMoreDoes) {
  v1::FindShapeRequest wanted = request(0.2);
  wanted.set_with_sensitivities(true);
  const SeenShape seen = find(wanted);
  ASSERT_TRUE(seen.status.ok()) << seen.status.error_message();
  ASSERT_EQ(seen.shape.sensitivities_size(), 5) << "one pool, two layers by stiffness and by thickness";
  const v1::ShapeSensitivity& by_volume = seen.shape.sensitivities(0);
  EXPECT_EQ(by_volume.parameter(), v1::ShapeSensitivity::POOL_VOLUME);
  EXPECT_EQ(by_volume.name(), seen.shape.pools(0).zones());
  const double step = 0.004;
  const SeenShape more = find(request(0.2 + step)), less = find(request(0.2 - step));
  const double pressure = (more.shape.pools(0).pressure_pa() - less.shape.pools(0).pressure_pa()) / (2.0 * step);
  EXPECT_NEAR(by_volume.pressure_pa(0), pressure, 0.03 * pressure);
  EXPECT_EQ(seen.shape.sensitivities(1).parameter(), v1::ShapeSensitivity::LAYER_STIFFNESS);
  EXPECT_FALSE(seen.shape.sensitivities(1).name().empty());
  EXPECT_EQ(seen.bytes.at("skin.sensitivity/0").size(), seen.bytes.at("skin.displacement").size());
  EXPECT_EQ(seen.shape.sensitivities(4).parameter(), v1::ShapeSensitivity::LAYER_THICKNESS);
  EXPECT_TRUE(seen.bytes.contains("skin.sensitivity/4"));
}

TEST_F(ShapeTest, BeginsFromThePlanOfASimulationAsItIsNow) {
  run(0.2, "x");
  v1::FindShapeRequest wanted;
  wanted.set_simulation("simulations/x");
  v1::AddedFat& added = *wanted.add_added();
  added.set_zone("middle");
  added.set_volume_ml(0.05);
  const SeenShape seen = find(wanted);
  ASSERT_TRUE(seen.status.ok()) << seen.status.error_message();
  EXPECT_LT(largest_difference(seen.bytes.at("skin.displacement"), find(request(0.25)).bytes.at("skin.displacement")),
            1e-6);
}

TEST_F(ShapeTest, RefusesByNameOfTheField) {
  v1::FindShapeRequest wrong = request(0.2);
  wrong.mutable_injections(0)->set_index(3);
  EXPECT_THAT(violations_of(find(wrong).status)["injections[0].index"], HasSubstr("has 1 injections"));
  wrong = request(1e4);
  EXPECT_TRUE(violations_of(find(wrong).status).contains("injections[0].volume_ml"));
  wrong = request(0.2);
  wrong.add_added()->set_zone("nose");
  EXPECT_TRUE(violations_of(find(wrong).status).contains("added[0].zone"));
  wrong = request(0.2, "Drag!");
  EXPECT_TRUE(violations_of(find(wrong).status).contains("drag"));
  wrong = request(0.2);
  wrong.mutable_spec()->mutable_films(0)->set_n_xi(0);
  EXPECT_TRUE(violations_of(find(wrong).status).contains("spec.films[0].n_xi"));
  EXPECT_TRUE(violations_of(find({}).status).contains("spec"));
  wrong = request(0.2);
  wrong.mutable_spec()->set_model("patients/anna/models/none");
  EXPECT_EQ(find(wrong).status.error_code(), grpc::StatusCode::NOT_FOUND);
  wrong = request(-5.0);
  const grpc::Status overdrawn = find(wrong).status;
  EXPECT_EQ(overdrawn.error_code(), grpc::StatusCode::FAILED_PRECONDITION) << overdrawn.error_message();
}

TEST_F(ShapeTest, SaysWhichFieldForbidsIt) {
  v1::FindShapeRequest stepped = request(0.2);
  stepped.mutable_spec()->mutable_fat()->set_yield_stress_pa(20.0);
  const grpc::Status refused = find(stepped).status;
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(refused.error_message(), HasSubstr("fat.yield_stress_pa"));
}

/// A client that floods is answered in each case, and others keep being served.
TEST_F(ShapeTest, AFloodOfADragIsAnsweredAndOthersAreServed) {
  ASSERT_TRUE(find(request(0.1, "drag")).status.ok());
  constexpr int kCallers = 4, kCalls = 100;
  std::atomic<int> found = 0, superseded = 0, other = 0;
  std::vector<std::thread> callers;
  for (int caller = 0; caller < kCallers; ++caller) {
    callers.emplace_back([&, caller] {
      for (int k = 0; k < kCalls; ++k) {
        const grpc::Status status = find(request(0.1 + 0.001 * k + 0.0001 * caller, "drag")).status;
        ++(status.ok() ? found : status.error_code() == grpc::StatusCode::ABORTED ? superseded : other);
      }
    });
  }
  const v1::Simulation simulation = run(0.2, "x");
  EXPECT_EQ(simulation.state(), v1::Simulation::SETTLED);
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(found + superseded, kCallers * kCalls);
  EXPECT_EQ(other, 0);
  EXPECT_GT(found, 0);
}

}  // namespace
}  // namespace lipofill::testing
