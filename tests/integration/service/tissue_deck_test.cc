// ExportTissueDeck: decks of simulations that have not begun, have ended, and have no tissue.

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Download {
  grpc::Status status;
  std::string text;
  double time_s = -1.0;
  int pieces = 0;
};

class TissueDeckTest : public ServiceTest {
 protected:
  void SetUp() override { create_patient(); }

  Download download(const std::string& name) {
    Context context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(120));
    v1::ExportTissueDeckRequest request;
    request.set_name(name);
    const auto reader = simulations_->ExportTissueDeck(&context, request);
    Download result;
    v1::ExportTissueDeckResponse piece;
    while (reader->Read(&piece)) {
      EXPECT_LE(piece.data().size(), size_t{1} << 20);
      EXPECT_THAT(piece.data(), EndsWith("\n"));
      result.text += piece.data();
      result.time_s = piece.time_s();
      ++result.pieces;
    }
    result.status = reader->Finish();
    return result;
  }

  void create(const v1::SimulationSpec& spec, const std::string& id, bool start) {
    v1::Simulation simulation;
    const grpc::Status status = create_simulation(spec, id, start, simulation);
    ASSERT_TRUE(status.ok()) << status.error_message();
  }
};

TEST_F(TissueDeckTest, IsThatOfThePresentState) {
  create(square_plan(build_square().name(), 0.2), "s", false);
  const Download before = download("simulations/s");
  ASSERT_TRUE(before.status.ok()) << before.status.error_message();
  EXPECT_EQ(before.time_s, 0.0);
  EXPECT_THAT(before.text, StartsWith("*HEADING\n"));
  EXPECT_THAT(before.text, HasSubstr("NAME=LAYER1_SKIN\n"));
  EXPECT_THAT(before.text, HasSubstr(", P1, 0.000000000000e+00\n"));
  EXPECT_THAT(before.text, EndsWith("*END STEP\n"));

  v1::StartSimulationRequest request;
  request.set_name("simulations/s");
  v1::Simulation started;
  ASSERT_TRUE(call(*simulations_, &v1::SimulationService::Stub::StartSimulation, request, started).ok());
  await_end("simulations/s");
  const Download after = download("simulations/s");
  ASSERT_TRUE(after.status.ok()) << after.status.error_message();
  EXPECT_NEAR(after.time_s, 0.2, 1e-9);
  EXPECT_THAT(after.text, ::testing::Not(HasSubstr(", P1, 0.000000000000e+00\n")));
  // The mesh is the same, the loads are not.
  EXPECT_EQ(after.text.substr(0, after.text.find("*STEP")), before.text.substr(0, before.text.find("*STEP")));
  restart();
  EXPECT_EQ(download("simulations/s").text, after.text);
}

TEST_F(TissueDeckTest, ComesInPieces) {
  v1::ModelSpec spec = square_spec();
  spec.set_n_xi(64);
  spec.set_n_eta(64);
  v1::Operation operation;
  ASSERT_TRUE(build("patients/anna", spec, operation).ok());
  v1::Model model;
  ASSERT_TRUE(operation.response().UnpackTo(&model));
  create(square_plan(model.name(), 1.0), "large", false);
  const Download deck = download("simulations/large");
  ASSERT_TRUE(deck.status.ok()) << deck.status.error_message();
  EXPECT_GT(deck.pieces, 1);
  EXPECT_THAT(deck.text, EndsWith("*END STEP\n"));
  EXPECT_EQ(download("simulations/large").text, deck.text);

  // A client that leaves after the first piece is no trouble.
  Context context;
  v1::ExportTissueDeckRequest request;
  request.set_name("simulations/large");
  const auto reader = simulations_->ExportTissueDeck(&context, request);
  v1::ExportTissueDeckResponse piece;
  ASSERT_TRUE(reader->Read(&piece));
  context.TryCancel();
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(is_serving());
}

TEST_F(TissueDeckTest, NeedsATissue) {
  auto spec = parse_text<v1::ModelSpec>("square { length_xi_mm: 40 length_eta_mm: 40 } n_xi: 2 n_eta: 2");
  v1::Operation operation;
  ASSERT_TRUE(build("patients/anna", spec, operation).ok());
  v1::Model model;
  ASSERT_TRUE(operation.response().UnpackTo(&model));
  v1::SimulationSpec plan = square_plan(model.name(), 1.0);
  plan.mutable_films(0)->clear_below_layer();
  plan.mutable_films(0)->mutable_wall()->set_kind(v1::FilmWall::RIGID);
  create(plan, "bare", false);
  const Download bare = download("simulations/bare");
  EXPECT_EQ(bare.status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(bare.status.error_message(), HasSubstr("no layers"));
}

TEST_F(TissueDeckTest, NeedsItsModel) {
  const std::string model = build_square().name();
  create(square_plan(model, 0.1), "s", true);
  await_end("simulations/s");
  v1::DeleteModelRequest request;
  request.set_name(model);
  google::protobuf::Empty nothing;
  ASSERT_TRUE(call(*patients_, &v1::PatientService::Stub::DeleteModel, request, nothing).ok());
  // What was in memory may still serve; the store alone cannot.
  restart();
  const Download late = download("simulations/s");
  EXPECT_EQ(late.status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(late.status.error_message(), HasSubstr(model));
}

TEST_F(TissueDeckTest, RefusesNamesOfNothing) {
  EXPECT_EQ(download("simulations/none").status.error_code(), grpc::StatusCode::NOT_FOUND);
  for (const std::string& name : {std::string(), std::string("patients/anna"), std::string(100000, 'x')}) {
    const Download refused = download(name);
    EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(violations_of(refused.status).count("name"), 1u);
  }
  EXPECT_TRUE(is_serving());
}

}  // namespace
}  // namespace lipofill::testing
