// The daemon is killed with SIGKILL at seeded random moments while clients create, steer, keep,
// restore and delete simulations, watch them and upload scans; between two lives files are taken
// away, replaced by older ones and spoilt by a bit. While it lives, its disk runs full, descriptors
// and memory run out, its clock is set, it stands still, and strangers flood it or do not read what
// they ask for. What clients were told must hold.
// LIPOFILL_CHAOS_KILLS and LIPOFILL_CHAOS_SEED say how often and in which order (deploy/chaos),
// LIPOFILL_CHAOS_KEEP where to leave data and log when it fails.

#include <cstdlib>
#include <filesystem>
#include <random>
#include <thread>

#include "absl/strings/str_cat.h"
#include "server/store/checkpoint_files.h"
#include "server/store/scan_files.h"
#include "server/store/sql_store.h"
#include "server/store/verification.h"
#include "tests/integration/chaos/meddler.h"
#include "tests/integration/chaos/planner.h"
#include "tests/integration/chaos/spectator.h"
#include "tests/integration/chaos/tormentor.h"
#include "tests/integration/chaos/uploader.h"
#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::IsEmpty;

constexpr int kPlanners = 3;
constexpr int kKillsInCi = 60;

uint64_t number_from_environment(const char* name, uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

v1::ModelSpec small_square() {
  return parse_text<v1::ModelSpec>(R"(
    square { length_xi_mm: 40 length_eta_mm: 40 } n_xi: 8 n_eta: 8
    layers { name: "skin" thickness_mm { constant: 2 } youngs_modulus_kpa: 100 poisson_ratio: 0.45 density_kg_m3: 1100 }
    layers { name: "deep" thickness_mm { constant: 4 } youngs_modulus_kpa: 20 poisson_ratio: 0.45 density_kg_m3: 1000 })");
}

/// Every file below the data directory belongs to a record, and every record's file is there and
/// whole.
void check_files(const std::string& data) {
  const auto store = server::SqlStore::open(data + "/lipofill.sqlite");
  ASSERT_TRUE(store.ok()) << store.status();
  const auto checkpoints = server::CheckpointFiles::open(data + "/checkpoints");
  const auto scans = server::ScanFiles::open(data + "/scans");
  ASSERT_TRUE(checkpoints.ok() && scans.ok());
  EXPECT_THAT(checkpoints->files().list_unknown([&](const std::string& simulation, const std::string& id) {
    const auto record = (*store)->get_checkpoint(simulation, id);
    return record.ok() && checkpoints->read(simulation, id, record->sha256).ok();
  }),
              IsEmpty())
      << "files of checkpoints that are in no record, or not whole";
  EXPECT_THAT(scans->files().list_unknown([&](const std::string& patient, const std::string& id) {
    const auto record = (*store)->get_scan(patient, id);
    return record.ok() && (!record->complete || scans->read_whole(patient, id, record->sha256).ok());
  }),
              IsEmpty())
      << "files of scans that are in no record, or not whole";
  EXPECT_FALSE(std::filesystem::exists(data + "/set-aside")) << "no death leaves a file that nobody knows";
  const auto found = server::verify_store(data, data + "/lipofill.sqlite", [](const server::Verification&) {});
  ASSERT_TRUE(found.ok()) << found.status();
  for (const server::Damage& damage : found->damages) ADD_FAILURE() << damage.name << ": " << damage.what;
  const auto simulations = (*store)->list_simulations({}, {"", 100'000});
  ASSERT_TRUE(simulations.ok());
  for (const server::SimulationRecord& simulation : *simulations) {
    const auto kept = (*store)->list_checkpoints(simulation.id, {"", 1000});
    ASSERT_TRUE(kept.ok());
    for (const server::CheckpointRecord& record : *kept) {
      EXPECT_TRUE(checkpoints->read(simulation.id, record.id, record.sha256).ok()) << simulation.id << record.id;
    }
  }
}

/// Daemons that are started as long as it is there have a clock that can be set, and allocations
/// that can be made to fail.
class OtherLibraries {
 public:
  explicit OtherLibraries(Tormentor::Files files) : files_(std::move(files)) {
#ifdef LIPOFILL_TEST_LIBRARIES
    ::setenv("LIPOFILL_TEST_CLOCK", files_.clock.c_str(), 1);
    ::setenv("LIPOFILL_TEST_SCARCE", files_.scarce.c_str(), 1);
    ::setenv("LD_PRELOAD", LIPOFILL_TEST_LIBRARIES, 1);
#endif
  }
  ~OtherLibraries() {
    ::unsetenv("LD_PRELOAD");
  }
  const Tormentor::Files& files() const {
    return files_;
  }

 private:
  const Tormentor::Files files_;
};

TEST(Chaos, WhatWasAcknowledgedHoldsHoweverOftenTheDaemonIsKilled) {
  const uint64_t kills = number_from_environment("LIPOFILL_CHAOS_KILLS", kKillsInCi);
  const uint64_t seed = number_from_environment("LIPOFILL_CHAOS_SEED", 1);
  SCOPED_TRACE(absl::StrCat("LIPOFILL_CHAOS_SEED=", seed, " LIPOFILL_CHAOS_KILLS=", kills));
  std::mt19937_64 random(seed);
  TemporaryDirectory directory;
  const OtherLibraries libraries({directory.file("clock"), directory.file("scarce")});
  ChaosDaemon daemon(directory.file("data"), {"--checkpoint-interval-s", "0.05", "--log-level", "info"});
  std::vector<std::unique_ptr<Planner>> planners;
  for (int i = 0; i < kPlanners; ++i) {
    planners.push_back(std::make_unique<Planner>(daemon, small_square(), i, random()));
  }
  Uploader uploader(daemon);
  Spectator spectator(daemon, [&] { return planners[0]->present(); });

  Meddler meddler(daemon.data(), random());
  Tormentor tormentor(daemon, random(), libraries.files());

  std::atomic<bool> stop = false;
  std::vector<std::thread> threads;
  for (const auto& planner : planners) threads.emplace_back([&] { planner->run(stop); });
  threads.emplace_back([&] { uploader.run(stop); });
  threads.emplace_back([&] { spectator.run(stop); });
  for (uint64_t kill = 0; kill < kills && !HasFailure(); ++kill) {
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 400));
    if (random() % 2 == 0) tormentor.torment();
    EXPECT_TRUE(daemon.lives()) << "it may only be killed by us, after " << tormentor.last();
    if (random() % 2 == 0) tormentor.let_go();
    if (random() % 5 == 0 && ++kill < kills) {
      daemon.kill_twice_and_restart(std::chrono::milliseconds(random() % 100));
    } else if (random() % 2 == 0) {
      daemon.kill_and_restart([&meddler] { meddler.meddle(); });
    } else {
      daemon.kill_and_restart();
    }
  }
  stop = true;
  for (std::thread& thread : threads) thread.join();
  daemon.kill_and_restart();

  int commands = 0;
  size_t results = 0;
  int lacked_memory = 0;
  for (const auto& planner : planners) {
    planner->check_ledger();
    commands += planner->ledger().commands;
    results += planner->ledger().results.size();
    lacked_memory += planner->ledger().lacked_memory;
  }
  uploader.check();
  daemon.kill_and_restart();
  check_files(daemon.data());
  std::cout << kills << " kills, seed " << seed << ": " << commands << " commands acknowledged, " << results
            << " results equal to an unbroken run, " << lacked_memory << " that lacked memory, " << uploader.complete()
            << " scans, " << spectator.frames() << " frames in " << spectator.epochs() << " epochs; "
            << meddler.removed() << " checkpoints removed, " << meddler.replaced() << " replaced by others, "
            << meddler.flipped() << " bits flipped";
  for (size_t i = 0; i < kTormentNames.size(); ++i) {
    std::cout << "; " << kTormentNames[i] << ": " << tormentor.count(static_cast<Torment>(i));
  }
  std::cout << "\n";
  if (const char* keep = std::getenv("LIPOFILL_CHAOS_KEEP"); keep != nullptr && HasFailure()) {
    std::filesystem::copy(directory.path(), keep, std::filesystem::copy_options::recursive);
  }
  EXPECT_GT(results, 0u);
  EXPECT_GT(spectator.epochs(), 1u);
}

}  // namespace
}  // namespace lipofill::testing
