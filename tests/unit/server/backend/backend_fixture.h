#pragma once

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/backend/await.h"
#include "server/backend/backend.h"
#include "server/backend/model_reading.h"
#include "server/backend/simulation_creation.h"
#include "tests/unit/server/store/open_store.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {

/// A daemon's inside on a data directory of its own, with a square model; no network. It can end
/// and begin again.
class BackendTest : public ::testing::Test {
 protected:
  static constexpr char kModel[] = "patients/anna/models/m";

  BackendTest() {
    options_.workers = 2;
    begin();
    keep_model();
  }

  template <typename Message>
  static Message parse(const std::string& text) {
    Message message;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
    return message;
  }
  /// A film with a wall of its own: steps of microseconds, 0.1 s of injection.
  static v1::SimulationSpec make_plan(double end_s) {
    auto plan = parse<v1::SimulationSpec>(R"(
      fat { viscosity_pa_s: 50 }
      films { name: "plane" n_xi: 3 n_eta: 3
              zones { name: "all" box { xi_min: 0 xi_max: 1 eta_min: 0 eta_max: 1 } }
              wall { kind: WINKLER stiffness_kpa_per_mm: 10 } }
      injections { zone: "all" volume_ml: 0.1 rate_ml_per_s: 1 start_s: 0 }
      time { step_ms: 10 settle_skin_speed_mm_per_s: 0 })");
    plan.set_model(kModel);
    plan.mutable_time()->set_end_s(end_s);
    return plan;
  }

  /// Ends as the daemon does, and opens what was kept.
  void restart() {
    backend_->sessions.suspend_all();
    begin();
  }
  void begin() {
    backend_ = nullptr;
    store_ = nullptr;
    store_ = open_store(directory_.file("db"));
    auto scans = ScanFiles::open(directory_.path() / "scans");
    auto checkpoints = CheckpointFiles::open(directory_.path() / "checkpoints");
    ASSERT_TRUE(scans.ok() && checkpoints.ok());
    scans_ = std::make_unique<ScanFiles>(*std::move(scans));
    checkpoints_ = std::make_unique<CheckpointFiles>(*std::move(checkpoints));
    metrics_ = std::make_unique<Metrics>();
    backend_ = std::make_unique<Backend>(options_, *store_, *scans_, *checkpoints_, *metrics_);
  }

  v1::Simulation create(const std::string& id, double end_s, bool start = false) {
    v1::CreateSimulationRequest request;
    request.set_simulation_id(id);
    request.set_start(start);
    *request.mutable_spec() = make_plan(end_s);
    const auto made = create_simulation(*backend_, {}, request, nullptr);
    EXPECT_TRUE(made.ok()) << made.status();
    return made.ok() ? *made : v1::Simulation();
  }
  SimulationRecord record_of(const std::string& id) {
    const auto record = store_->get_simulation(id);
    EXPECT_TRUE(record.ok()) << record.status();
    return record.ok() ? *record : SimulationRecord();
  }
  /// Waits until the simulation has ended and its result is in the store.
  void await_end(const std::string& id) {
    for (int i = 0; i < 20'000 && !has_ended(record_of(id).state); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_TRUE(has_ended(record_of(id).state)) << id;
  }
  /// Asks a session to give up its memory until it has.
  void park(const std::string& id) {
    for (int i = 0; i < 2'000 && backend_->sessions.find(id) != nullptr; ++i) {
      if (i % 100 == 0) backend_->sessions.find(id)->park(std::chrono::duration<double>(0.0));
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ASSERT_EQ(backend_->sessions.find(id), nullptr) << id << " has not been parked in 20 s";
  }
  absl::StatusOr<SessionView> inspect(const std::string& id) {
    const auto session = backend_->sessions.hold(id);
    if (session == nullptr) return absl::NotFoundError(id);
    return await<absl::StatusOr<SessionView>>([&](auto reply) { session->inspect(std::move(reply)); });
  }

  lipofill::testing::TemporaryDirectory directory_;
  BackendOptions options_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<ScanFiles> scans_;
  std::unique_ptr<CheckpointFiles> checkpoints_;
  std::unique_ptr<Metrics> metrics_;
  std::unique_ptr<Backend> backend_;

 private:
  void keep_model() {
    ASSERT_TRUE(store_->create_patient({"anna", "", {}, 1}, {}).ok());
    const auto message = parse<v1::ModelSpec>("square { length_xi_mm: 40 length_eta_mm: 40 } n_xi: 4 n_eta: 4");
    const auto spec = read_model_spec(*backend_, "anna", message);
    ASSERT_TRUE(spec.ok()) << spec.status();
    const auto model = model::build_face_model(*spec, [](double, const char*) { return true; });
    ASSERT_TRUE(model.ok()) << model.status();
    ModelRecord record;
    record.patient = "anna";
    record.id = "m";
    record.content_hash = (*model)->content_hash;
    record.spec_message = message.SerializeAsString();
    ASSERT_TRUE(store_->create_model(record, {}).ok());
  }
};

}  // namespace lipofill::server
