// The text of a deck, read back.

#include "core/export/calculix_deck.h"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <map>
#include <sstream>

#include "core/export/wall_pressure.h"
#include "core/solid/hex_shape.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

/// What a reader of the format sees: cards with their lines of comma-separated values.
struct Card {
  std::string head;
  std::vector<std::vector<std::string>> lines;
};

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::vector<Card> parse(const std::string& text) {
  std::vector<Card> cards;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("**")) continue;
    if (line.starts_with("*")) {
      cards.push_back({line, {}});
      continue;
    }
    std::vector<std::string> values;
    std::istringstream parts(line);
    for (std::string value; std::getline(parts, value, ',');) values.push_back(trimmed(value));
    cards.back().lines.push_back(values);
  }
  return cards;
}

std::string read_all(exporting::CalculixDeck& deck, size_t piece_bytes = size_t{1} << 20) {
  std::string text;
  for (std::string piece = deck.read(piece_bytes); !piece.empty(); piece = deck.read(piece_bytes)) {
    EXPECT_LE(piece.size(), piece_bytes);
    EXPECT_EQ(piece.back(), '\n');
    text += piece;
  }
  return text;
}

/// A deck by its cards.
class Deck {
 public:
  explicit Deck(const std::string& text) : cards_(parse(text)) {}

  std::vector<Card> all(const std::string& head) const {
    std::vector<Card> found;
    for (const Card& card : cards_) {
      if (card.head.starts_with(head)) found.push_back(card);
    }
    return found;
  }
  /// The numbers of a set; empty when there is none.
  std::vector<int> set(const std::string& name) const {
    std::vector<int> members;
    for (const Card& card : all("*NSET, NSET=" + name)) {
      if (card.head != "*NSET, NSET=" + name) continue;
      for (const auto& line : card.lines) {
        for (const std::string& value : line) members.push_back(std::stoi(value));
      }
    }
    return members;
  }
  std::map<int, Eigen::Vector3d> nodes() const {
    std::map<int, Eigen::Vector3d> positions;
    const Card card = all("*NODE, NSET=ALL").at(0);
    for (const auto& line : card.lines) {
      positions[std::stoi(line.at(0))] = {std::stod(line.at(1)), std::stod(line.at(2)), std::stod(line.at(3))};
    }
    return positions;
  }

 private:
  std::vector<Card> cards_;
};

std::vector<Eigen::VectorXd> constant_pressure(int n_cells, double pressure) {
  return {Eigen::VectorXd::Constant(n_cells, pressure)};
}

Deck write_deck(const model::FaceModel& model, const plan::SimulationSpec& spec,
                const std::vector<Eigen::VectorXd>& pressures) {
  auto deck = exporting::CalculixDeck::create(model, spec, pressures);
  EXPECT_TRUE(deck.ok()) << deck.status();
  return Deck(deck.ok() ? read_all(*deck) : "");
}

TEST(CalculixDeck, HasEveryNodeAndElementOfTheSplitMesh) {
  const auto model = make_small_model();
  const Deck deck = write_deck(*model, make_small_plan(), constant_pressure(36, 500.0));
  // Three levels of 13 x 13 nodes; those of the film's level are there twice, on the rim too.
  EXPECT_EQ(deck.nodes().size(), 4u * 169u);
  const auto elements = deck.all("*ELEMENT, TYPE=C3D8I");
  ASSERT_EQ(elements.size(), 2u);
  EXPECT_EQ(elements[0].head, "*ELEMENT, TYPE=C3D8I, ELSET=LAYER1_SKIN");
  EXPECT_EQ(elements[1].head, "*ELEMENT, TYPE=C3D8I, ELSET=LAYER2_MUSCLE");
  EXPECT_EQ(elements[0].lines.size(), 144u);
  EXPECT_EQ(elements[1].lines.front().at(0), "145");
  EXPECT_EQ(elements[1].lines.back().at(0), "288");
  EXPECT_EQ(deck.set("SKIN").size(), 169u);
  // The rim, and what of the base is not rim.
  EXPECT_EQ(deck.set("FIXED").size(), 4u * 48u + 121u);
  EXPECT_TRUE(deck.set("HELD_X").empty());
  EXPECT_TRUE(deck.all("*SPRING").empty());
}

TEST(CalculixDeck, ElementsHaveAPositiveJacobianInTheOrderWritten) {
  model::FaceModelSpec spec = make_small_model_spec();
  spec.layers[1].geometry.elements_through = 3;
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok());
  const Deck deck = write_deck(**model, make_small_plan(), constant_pressure(36, 500.0));
  const auto nodes = deck.nodes();
  int count = 0;
  double volume = 0.0;
  for (const Card& card : deck.all("*ELEMENT, TYPE=C3D8I")) {
    for (const auto& line : card.lines) {
      ASSERT_EQ(line.size(), 9u);
      solid::HexNodes corners;
      for (int a = 0; a < 8; ++a) corners.col(a) = nodes.at(std::stoi(line[a + 1]));
      // Nodes 1-4 lie deeper than 5-8: the faces under the film's pressure are the first and the
      // second.
      for (int a = 0; a < 4; ++a) EXPECT_LT(corners(2, a), corners(2, a + 4));
      for (const auto& point : solid::hex_gauss_points()) {
        const double jacobian = solid::compute_jacobian(corners, point).determinant();
        EXPECT_GT(jacobian, 0.0);
        volume += jacobian;
      }
      ++count;
    }
  }
  EXPECT_EQ(count, 4 * 144);
  EXPECT_NEAR(volume, 48.0 * 48.0 * 10.0, 1e-6 * 48.0 * 48.0 * 10.0);
}

/// C10 = mu/2 and D1 = 2/kappa, in MPa.
TEST(CalculixDeck, WritesTheLawOfEachLayer) {
  model::FaceModelSpec spec = make_small_model_spec();
  spec.layers[1].material.law = solid::TissueLaw::kNeoHookean;
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok());
  const Deck deck = write_deck(**model, make_small_plan(), constant_pressure(36, 500.0));
  ASSERT_EQ(deck.all("*ELASTIC").size(), 1u);
  EXPECT_DOUBLE_EQ(std::stod(deck.all("*ELASTIC")[0].lines[0].at(0)), 0.1);
  const auto neo_hookean = deck.all("*HYPERELASTIC, NEO HOOKE");
  ASSERT_EQ(neo_hookean.size(), 1u);
  EXPECT_NEAR(std::stod(neo_hookean[0].lines[0].at(0)), 0.5 * 0.2 / (2.0 * 1.45), 1e-12);
  EXPECT_NEAR(std::stod(neo_hookean[0].lines[0].at(1)), 2.0 * 3.0 * (1.0 - 0.9) / 0.2, 1e-12);
}

TEST(CalculixDeck, PressesBothWallsApart) {
  const auto model = make_small_model();
  plan::SimulationSpec plan = make_small_plan();
  plan.films[0].zones = {{"half", geometry::ChartBox{0.0, 0.5, 0.0, 1.0}}};
  const Deck deck = write_deck(*model, plan, constant_pressure(18, 500.0));
  const auto loads = deck.all("*DLOAD");
  ASSERT_EQ(loads.size(), 2u);
  for (int wall = 0; wall < 2; ++wall) {
    ASSERT_EQ(loads[wall].lines.size(), 72u);
    for (const auto& line : loads[wall].lines) {
      const int element = std::stoi(line.at(0));
      EXPECT_EQ((element - 1) / 144, wall);
      EXPECT_LT((element - 1) % 12, 6);
      EXPECT_EQ(line.at(1), wall == 0 ? "P1" : "P2");
      EXPECT_DOUBLE_EQ(std::stod(line.at(2)), 500e-6);
    }
  }
  const auto surfaces = deck.all("*SURFACE");
  ASSERT_EQ(surfaces.size(), 2u);
  EXPECT_EQ(surfaces[0].head, "*SURFACE, NAME=FILM1_FILM_OUTER, TYPE=ELEMENT");
  EXPECT_EQ(surfaces[1].head, "*SURFACE, NAME=FILM1_FILM_INNER, TYPE=ELEMENT");
  EXPECT_EQ(surfaces[1].lines.front().at(1), "S2");
}

TEST(CalculixDeck, AFilmOnBonePressesOneWallAndLeavesBoneOut) {
  const auto model = make_small_model();
  plan::SimulationSpec plan = make_small_plan();
  plan.films[0].below_layer = "muscle";
  const Deck deck = write_deck(*model, plan, constant_pressure(36, 500.0));
  ASSERT_EQ(deck.all("*DLOAD").size(), 1u);
  EXPECT_EQ(deck.all("*DLOAD")[0].lines.front().at(1), "P1");
  EXPECT_EQ(deck.set("BONE").size(), 169u);
  const auto fixed = deck.set("FIXED");
  for (const int node : deck.set("BONE")) EXPECT_EQ(std::count(fixed.begin(), fixed.end(), node), 0);
}

TEST(CalculixDeck, HoldsRollersAndElasticSupports) {
  model::FaceModelSpec spec = make_small_model_spec();
  spec.rim.kind = model::SupportKind::kRollers;
  spec.base = {model::SupportKind::kElastic, 2e6};
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok());
  const Deck deck = write_deck(**model, make_small_plan(), constant_pressure(36, 0.0));
  EXPECT_TRUE(deck.set("FIXED").empty());
  EXPECT_EQ(deck.set("HELD_X").size(), 4u * 26u);
  EXPECT_EQ(deck.set("HELD_Y").size(), 4u * 26u);
  EXPECT_TRUE(deck.set("HELD_Z").empty());
  // The springs of one direction together carry the stiffness of the whole base, 2 kPa/mm over
  // 48 x 48 mm; along x and y those of the sides on rollers are not there.
  const auto elements = deck.all("*ELEMENT, TYPE=SPRING1");
  const auto springs = deck.all("*SPRING, ELSET");
  ASSERT_EQ(elements.size(), springs.size());
  std::array<double, 4> total = {};
  for (size_t k = 0; k < springs.size(); ++k) {
    const int direction = std::stoi(springs[k].lines.at(0).at(0));
    total[direction] += static_cast<double>(elements[k].lines.size()) * std::stod(springs[k].lines.at(1).at(0));
  }
  EXPECT_NEAR(total[3], 2e-3 * 48.0 * 48.0, 1e-9);
  EXPECT_NEAR(total[1], 2e-3 * 44.0 * 48.0, 1e-9);
  EXPECT_NEAR(total[2], 2e-3 * 44.0 * 48.0, 1e-9);
}

TEST(CalculixDeck, MaterialAndGravityAreInMillimetresNewtonAndTonne) {
  const auto model = make_small_model();
  plan::SimulationSpec plan = make_small_plan();
  plan.gravity = {0.0, 0.0, -9.81};
  const Deck deck = write_deck(*model, plan, constant_pressure(36, 0.0));
  const auto elastic = deck.all("*ELASTIC");
  ASSERT_EQ(elastic.size(), 2u);
  EXPECT_DOUBLE_EQ(std::stod(elastic[0].lines[0][0]), 0.1);
  EXPECT_DOUBLE_EQ(std::stod(elastic[1].lines[0][0]), 0.2);
  EXPECT_DOUBLE_EQ(std::stod(elastic[0].lines[0][1]), 0.45);
  EXPECT_DOUBLE_EQ(std::stod(deck.all("*DENSITY")[1].lines[0][0]), 1.05e-9);
  const Card gravity = deck.all("*DLOAD").back();
  ASSERT_EQ(gravity.lines.size(), 2u);
  EXPECT_EQ(gravity.lines[0][1], "GRAV");
  EXPECT_DOUBLE_EQ(std::stod(gravity.lines[0][2]), 9810.0);
  EXPECT_DOUBLE_EQ(std::stod(gravity.lines[0][5]), -1.0);
}

TEST(CalculixDeck, ReadsTheSameInPiecesOfAnySize) {
  const auto model = make_small_model();
  const auto pressures = constant_pressure(36, 500.0);
  auto whole = exporting::CalculixDeck::create(*model, make_small_plan(), pressures);
  auto pieces = exporting::CalculixDeck::create(*model, make_small_plan(), pressures);
  ASSERT_TRUE(whole.ok() && pieces.ok());
  EXPECT_EQ(read_all(*whole, size_t{64} << 20), read_all(*pieces, exporting::CalculixDeck::kLongestLine));
}

TEST(CalculixDeck, NamesOfThePlanCannotBreakTheText) {
  model::FaceModelSpec spec = make_small_model_spec();
  spec.layers[0].name = "skin, \n*STEP " + std::string(300, 'x');
  spec.layers[1].name = "skin, \n*STEP " + std::string(300, 'x') + "y";
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok());
  plan::SimulationSpec plan = make_small_plan();
  plan.films[0].below_layer = spec.layers[0].name;
  const Deck deck = write_deck(**model, plan, constant_pressure(36, 1.0));
  EXPECT_EQ(deck.all("*STEP").size(), 1u);
  const auto elements = deck.all("*ELEMENT, TYPE=C3D8I");
  ASSERT_EQ(elements.size(), 2u);
  EXPECT_NE(elements[0].head, elements[1].head);
  EXPECT_LT(elements[0].head.size(), 80u);
}

TEST(CalculixDeck, TakesThePressureOfARunningSimulation) {
  const auto simulation = make_small_simulation();
  ASSERT_TRUE(simulation);
  for (int step = 0; step < 20; ++step) simulation->advance_step();
  auto made = exporting::CalculixDeck::create(*simulation);
  ASSERT_TRUE(made.ok()) << made.status();
  const Deck deck(read_all(*made));
  double highest = 0.0;
  const Card loads = deck.all("*DLOAD").at(0);
  for (const auto& line : loads.lines) highest = std::max(highest, std::stod(line[2]));
  EXPECT_NEAR(highest, simulation->report().max_pressure * 1e-6, 1e-6 * highest);
}

TEST(CalculixDeck, NamesTheForcesItLeavesOut) {
  const auto head_of = [](const model::FaceModelSpec& spec, const plan::SimulationSpec& plan) {
    const auto model = model::build_face_model(spec, nullptr);
    EXPECT_TRUE(model.ok()) << model.status();
    auto deck = exporting::CalculixDeck::create(**model, plan, constant_pressure(36, 1.0));
    EXPECT_TRUE(deck.ok()) << deck.status();
    return deck->read(exporting::CalculixDeck::kLongestLine);
  };
  model::FaceModelSpec spec = make_small_model_spec();
  plan::SimulationSpec plan = make_small_plan();
  EXPECT_THAT(head_of(spec, plan), ::testing::Not(::testing::HasSubstr("not in this deck")));
  spec.layers[0].material.prestress = 1000.0;
  plan.films[0].connective_tissue.stiffness = 1e5;
  plan.ligaments = {
      {"band", "film", "", std::vector<geometry::SkinPoint>{geometry::ChartPoint{0.5, 0.5}}, 100.0, 0.0, std::nullopt}};
  EXPECT_THAT(head_of(spec, plan), ::testing::HasSubstr("but not in this deck: ligaments, fibres across the film FILM, "
                                                        "prestress of the layer SKIN\n"));
}

TEST(CalculixDeck, RefusesWhatIsNoTissueOrNoPressure) {
  model::FaceModelSpec bare;
  bare.region = geometry::SquareSpec{0.04, 0.04};
  bare.n_xi = bare.n_eta = 4;
  const auto without_layers = model::build_face_model(bare, nullptr);
  ASSERT_TRUE(without_layers.ok());
  EXPECT_EQ(exporting::CalculixDeck::create(**without_layers, {}, {}).status().code(),
            absl::StatusCode::kFailedPrecondition);
  const auto model = make_small_model();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& pressures :
       {std::vector<Eigen::VectorXd>{}, constant_pressure(35, 1.0), constant_pressure(36, nan)}) {
    EXPECT_EQ(exporting::CalculixDeck::create(*model, make_small_plan(), pressures).status().code(),
              absl::StatusCode::kInvalidArgument);
  }
}

TEST(WallPressure, IsThatOfTheCellsByTheShareTheyCover) {
  geometry::LayeredGrid tissue;
  tissue.n_xi = 4;
  tissue.n_eta = 2;
  // Two cells over three quarters of the width: borders at 0, 0.375, 0.75.
  const film::FilmGrid film = film::make_film_grid({0.0, 0.75, 0.0, 1.0}, 2, 1, {0, 0});
  const auto walls = exporting::spread_over_wall(tissue, film::cut_cells(film, tissue.n_xi, tissue.n_eta),
                                                 Eigen::Vector2d(100.0, 300.0));
  ASSERT_EQ(walls.size(), 6u);
  const std::array<double, 3> expected = {100.0, 200.0, 300.0};
  for (size_t k = 0; k < walls.size(); ++k) {
    EXPECT_EQ(walls[k].i, static_cast<int>(k % 3));
    EXPECT_EQ(walls[k].j, static_cast<int>(k / 3));
    EXPECT_NEAR(walls[k].pressure, expected[k % 3], 1e-9);
  }
}

}  // namespace
}  // namespace lipofill::simulation
