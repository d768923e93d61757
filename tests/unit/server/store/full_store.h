#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "core/base/hash.h"
#include "server/store/checkpoint_files.h"
#include "server/store/scan_files.h"
#include "server/store/sql_store.h"

namespace lipofill::server {

/// Makes a store in a data directory that has one of everything: a patient with a label, a scan
/// with its file, a model, a simulation with a command, a checkpoint, series and result, a plan
/// that it was made from, an operation with a part, and a request. The database is a file there,
/// unless another place is given.
inline std::unique_ptr<SqlStore> make_full_store(const std::filesystem::path& data, const std::string& place = "") {
  std::filesystem::create_directories(data);
  auto opened = SqlStore::open(place.empty() ? (data / "lipofill.sqlite").string() : place);
  EXPECT_TRUE(opened.ok()) << opened.status();
  std::unique_ptr<SqlStore> store = *std::move(opened);
  EXPECT_TRUE(store->create_patient({"anna", "the display name", {{"side", "left"}}, 1}, {"Create", "r1", "f"}).ok());
  const std::string bytes = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  Hasher hasher;
  hasher.add_bytes(bytes.data(), bytes.size());
  ScanRecord scan;
  scan.patient = "anna";
  scan.id = "scan-1";
  scan.size_bytes = scan.received_bytes = bytes.size();
  scan.sha256 = hasher.hex_digest();
  scan.complete = true;
  EXPECT_TRUE(store->create_scan(scan, {}).ok());
  EXPECT_TRUE(ScanFiles::open(data / "scans")->write("anna", "scan-1", 0, bytes).ok());
  ModelRecord model;
  model.patient = "anna";
  model.id = "model-1";
  model.scan = "scan-1";
  model.content_hash = "hash";
  model.spec_message = "the landmarks of a model";
  EXPECT_TRUE(store->create_model(model, {}).ok());
  SimulationRecord simulation;
  simulation.id = "sim-1";
  simulation.model = "patients/anna/models/model-1";
  simulation.spec_message = "the plan of a simulation";
  EXPECT_TRUE(store->create_simulation(simulation, {}).ok());
  EXPECT_TRUE(store->append_command({"sim-1", 0, CommandKind::kInject, 3, "an injection", 2}, "", {}).ok());
  const auto written =
      CheckpointFiles::open(data / "checkpoints")->write("sim-1", "kept-1", {"sim-1", 7, "a plan", "a snapshot"});
  CheckpointRecord checkpoint;
  checkpoint.simulation = "sim-1";
  checkpoint.id = "kept-1";
  checkpoint.kind = CheckpointKind::kAsked;
  checkpoint.step = 7;
  checkpoint.time_s = 0.07;
  checkpoint.size_bytes = written->size_bytes;
  checkpoint.sha256 = written->sha256;
  EXPECT_TRUE(store->create_checkpoint(checkpoint, SeriesChunk{1, 7, "rows of a series"}, {}).ok());
  simulation.state = SimulationState::kFinished;
  EXPECT_TRUE(store->end_simulation(simulation, {"meshes of a result", "the frame of a result"}).ok());
  PlanRecord plan;
  plan.patient = "anna";
  plan.id = "plan-1";
  plan.scan = "scan-1";
  plan.content_message = "what a plan keeps";
  plan.changes_message = "what changed in it";
  plan.create_time_us = 5;
  EXPECT_TRUE(store->create_plan(plan, {}).ok());
  EXPECT_TRUE(store->add_plan_run("anna", "plan-1", {"sim-1", "its hash", 6}).ok());
  EXPECT_TRUE(store->create_operation({"op-1", "anna", "local", "MakeForecast", "r2", "g", "what is asked"}).ok());
  EXPECT_TRUE(store->keep_operation_part("op-1", 3, "what was found").ok());
  return store;
}

}  // namespace lipofill::server
