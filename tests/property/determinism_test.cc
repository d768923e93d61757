// The same plan gives the same bytes: run again, and from many threads at once. Bytes that are no
// snapshot are refused.

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <thread>
#include <vector>

#include "core/coupling/thread_random.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

constexpr int kSteps = 25;

std::string hash_after(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.advance_step();
  return simulation.state_hash();
}

plan::SimulationSpec plan_with_everything(plan::CouplingMode coupling) {
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].zones = {{"left", geometry::ChartBox{0.0, 0.5, 0.0, 1.0}},
                         {"right", geometry::ChartBox{0.5, 1.0, 0.0, 1.0}}};
  spec.injections = {{"left", 0.1e-6, 1e-6, std::nullopt, std::nullopt},
                     {"right", 0.1e-6, 2e-6, std::nullopt, geometry::ChartPoint{0.7, 0.5}}};
  spec.coupling = coupling;
  spec.gravity = {1.0, -9.81, 2.0};
  spec.damping_mass = 1.0;
  spec.damping_stiffness = 1e-3;
  spec.max_step = 0.1;
  return spec;
}

TEST(Determinism, ARunAgainGivesTheSameBytes) {
  for (const plan::CouplingMode coupling : {plan::CouplingMode::kExact, plan::CouplingMode::kLumped}) {
    const plan::SimulationSpec spec = plan_with_everything(coupling);
    EXPECT_EQ(hash_after(*make_small_simulation(spec), kSteps), hash_after(*make_small_simulation(spec), kSteps));
  }
}

TEST(Determinism, ManyThreadsAtOnceGiveTheSameBytes) {
  const plan::SimulationSpec spec = plan_with_everything(plan::CouplingMode::kExact);
  const std::string alone = hash_after(*make_small_simulation(spec), kSteps);
  std::vector<std::string> hashes(6);
  std::vector<std::thread> threads;
  for (std::string& hash : hashes) {
    threads.emplace_back([&hash, &spec] { hash = hash_after(*make_small_simulation(spec), kSteps); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& hash : hashes) EXPECT_EQ(hash, alone);
}

/// Tissue whose best order is by nested dissection, with a film in its middle.
std::string hash_of_a_square_of_its_own() {
  model::FaceModelSpec face = make_small_model_spec();
  face.region = geometry::SquareSpec{0.04, 0.04};
  face.n_xi = face.n_eta = 8;
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].extent = geometry::ChartBox{0.125, 0.875, 0.125, 0.875};
  spec.films[0].n_xi = spec.films[0].n_eta = 3;
  spec.injections = {{"all", 0.05e-6, 0.1e-6, 0.0, std::nullopt}};
  spec.probes.clear();
  const auto model = model::build_face_model(face, nullptr);
  const auto simulation = Simulation::create(model.value(), spec);
  return hash_after(*simulation.value(), 8);
}

// Each thread orders its own tissue with METIS, which calls rand(); so does another thread all the
// while.
TEST(Determinism, ManyModelsAnalysedAtOnceGiveTheSameBytes) {
  constexpr int kThreads = 4, kRounds = 60;
  const std::string alone = hash_of_a_square_of_its_own();
  std::array<int, kThreads> others{};
  std::vector<std::thread> threads;
  for (int& other : others) {
    threads.emplace_back([&] {
      for (int k = 0; k < kRounds; ++k) other += hash_of_a_square_of_its_own() != alone;
    });
  }
  std::atomic<bool> done = false;
  std::thread stranger([&done] {
    while (!done) std::srand(static_cast<unsigned>(std::rand()));
  });
  for (std::thread& thread : threads) thread.join();
  done = true;
  stranger.join();
  for (const int other : others) EXPECT_EQ(other, 0);
  EXPECT_TRUE(coupling::has_random_numbers_of_its_own());
}

TEST(Injections, OfALiveRunAreBounded) {
  plan::SimulationSpec full = plan_with_everything(plan::CouplingMode::kExact);
  full.injections.assign(1000, {"left", 1e-9, 1e-6, 0.0, std::nullopt});
  const plan::InjectionSpec more{"left", 0.05e-6, 1e-6, std::nullopt, std::nullopt};
  EXPECT_EQ(make_small_simulation(full)->inject(more).code(), absl::StatusCode::kResourceExhausted);
}

/// `bytes` with a number at a place replaced.
template <typename T>
std::string with(std::string bytes, size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

TEST(Snapshot, RefusesWhatIsNotItsState) {
  const auto simulation = make_small_simulation();
  simulation->advance_step();
  const std::string good = simulation->snapshot();
  const std::string hash = simulation->state_hash();
  for (const std::string& bad : {std::string(), std::string("x"), good.substr(0, good.size() - 1), good + "x",
                                 "y" + good.substr(1), good.substr(0, 40)}) {
    EXPECT_EQ(simulation->restore(bad).code(), absl::StatusCode::kDataLoss);
    EXPECT_EQ(simulation->state_hash(), hash);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double backwards = -0.01;
  const int no_phase = 4;
  constexpr size_t kTime = 16 + 8, kPhaseFromTheEnd = 4 + 8 + 8 + 8 + 8;
  for (const std::string& impossible :
       {with(good, kTime, nan), with(good, kTime, backwards), with(good, good.size() - 8, nan),
        with(good, good.size() / 2 / 8 * 8, nan), with(good, good.size() - kPhaseFromTheEnd, no_phase)}) {
    EXPECT_EQ(simulation->restore(impossible).code(), absl::StatusCode::kDataLoss);
    EXPECT_EQ(simulation->state_hash(), hash);
  }
  plan::SimulationSpec other = make_small_plan();
  other.films[0].n_xi = 5;
  EXPECT_EQ(make_small_simulation(other)->restore(good).code(), absl::StatusCode::kDataLoss);
}

}  // namespace
}  // namespace lipofill::simulation
