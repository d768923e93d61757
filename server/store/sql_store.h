#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/store/database.h"
#include "server/store/owner_fence.h"
#include "server/store/store.h"
#include "server/store/transactor.h"

namespace lipofill::server {

/// The store in a database: a SQLite file, or PostgreSQL, which several daemons may share. One
/// connection, whose users take turns, see Transactor.
class SqlStore : public Store {
 public:
  /// Takes a database that is up to date, see open_database().
  explicit SqlStore(std::unique_ptr<Database> database) : database_(std::move(database)) {}
  /// Opens the store in the database that open_database() opens.
  static absl::StatusOr<std::unique_ptr<SqlStore>> open(const std::string& place);

  absl::StatusOr<PatientRecord> create_patient(const PatientRecord& patient, const RequestKey& request) override;
  absl::StatusOr<PatientRecord> get_patient(const std::string& id) override;
  absl::StatusOr<std::vector<PatientRecord>> list_patients(const Scope& scope, const Page& page) override;
  absl::StatusOr<PatientRecord> update_patient(const std::string& id, const PatientChange& change) override;
  absl::Status delete_patient(const std::string& id, bool force, const PatientCheck& check = nullptr) override;

  absl::StatusOr<ScanRecord> create_scan(const ScanRecord& scan, const RequestKey& request) override;
  absl::StatusOr<ScanRecord> get_scan(const std::string& patient, const std::string& id) override;
  absl::StatusOr<std::vector<ScanRecord>> list_scans(const std::string& patient, const Page& page) override;
  absl::StatusOr<std::vector<ScanRecord>> list_incomplete_scans() override;
  absl::Status set_scan_received(const std::string& patient, const std::string& id, uint64_t bytes) override;
  absl::Status complete_scan(const std::string& patient, const std::string& id,
                             const std::string& report_message) override;
  absl::Status delete_scan(const std::string& patient, const std::string& id) override;

  absl::StatusOr<ModelRecord> create_model(const ModelRecord& model, const RequestKey& request) override;
  absl::StatusOr<ModelRecord> get_model(const std::string& patient, const std::string& id) override;
  absl::StatusOr<std::vector<ModelRecord>> list_models(const std::string& patient, const Page& page) override;
  absl::Status delete_model(const std::string& patient, const std::string& id) override;

  absl::StatusOr<PlanRecord> create_plan(const PlanRecord& plan, const RequestKey& request) override;
  absl::StatusOr<PlanRecord> get_plan(const std::string& patient, const std::string& id) override;
  absl::StatusOr<std::vector<PlanRecord>> list_plans(const Scope& scope, const std::string& patient, const Page& page,
                                                     uint64_t most_bytes) override;
  absl::StatusOr<PlanRecord> update_plan(const std::string& patient, const std::string& id,
                                         const PlanChange& change) override;
  absl::Status delete_plan(const std::string& patient, const std::string& id,
                           const PlanCheck& check = nullptr) override;
  absl::StatusOr<std::vector<PlanRevisionRecord>> list_plan_revisions(const std::string& patient,
                                                                      const std::string& id) override;
  absl::StatusOr<PlanRevisionRecord> get_plan_revision(const std::string& patient, const std::string& id,
                                                       uint64_t number) override;
  absl::Status add_plan_run(const std::string& patient, const std::string& id, const PlanRunRecord& run) override;
  absl::StatusOr<std::vector<PlanRunRecord>> list_plan_runs(const std::string& patient, const std::string& id) override;

  absl::Status create_operation(const OperationRecord& operation) override;
  absl::StatusOr<std::vector<OperationRecord>> list_operations() override;
  absl::Status keep_operation_part(const std::string& id, int number, const std::string& bytes) override;
  absl::StatusOr<std::optional<std::string>> get_operation_part(const std::string& id, int number) override;
  absl::Status finish_operation(const std::string& id, const std::string& response_message) override;
  absl::Status forget_operation(const std::string& id) override;

  absl::StatusOr<SimulationRecord> create_simulation(const SimulationRecord& simulation,
                                                     const RequestKey& request) override;
  absl::StatusOr<SimulationRecord> get_simulation(const std::string& id) override;
  absl::StatusOr<std::vector<SimulationRecord>> list_simulations(const Scope& scope, const Page& page) override;
  absl::Status end_simulation(const SimulationRecord& ended, const SimulationResult& result) override;
  absl::Status set_simulation_state(const std::string& id, SimulationState state, const std::string& reason) override;
  absl::Status keep_summary(const std::string& id, const std::string& summary_message) override;
  absl::Status append_series(const std::string& id, const SeriesChunk& chunk) override;
  absl::StatusOr<std::optional<SeriesChunk>> next_series_chunk(const std::string& id, uint64_t after_step) override;
  absl::StatusOr<SimulationResult> get_result(const std::string& id) override;
  absl::Status delete_simulation(const std::string& id) override;
  absl::StatusOr<std::vector<SimulationRecord>> list_unended_simulations() override;
  absl::StatusOr<uint64_t> begin_epoch(const std::string& id, int64_t now_us) override;

  absl::StatusOr<bool> append_command(const CommandRecord& command, const std::string& spec_message,
                                      const RequestKey& request) override;
  absl::StatusOr<std::vector<CommandRecord>> list_commands(const std::string& simulation) override;

  absl::StatusOr<CheckpointRecord> create_checkpoint(const CheckpointRecord& checkpoint,
                                                     const std::optional<SeriesChunk>& rows,
                                                     const RequestKey& request) override;
  absl::StatusOr<CheckpointRecord> get_checkpoint(const std::string& simulation, const std::string& id) override;
  absl::StatusOr<std::vector<CheckpointRecord>> list_checkpoints(const std::string& simulation,
                                                                 const Page& page) override;
  absl::Status delete_checkpoint(const std::string& simulation, const std::string& id) override;
  absl::Status prune_checkpoints(const std::string& simulation, int newest) override;
  absl::StatusOr<uint64_t> count_checkpoint_bytes() override;

  absl::StatusOr<SimulationRecord> create_simulation_from(const SimulationRecord& simulation,
                                                          const CheckpointRecord& origin,
                                                          const RequestKey& request) override;
  absl::StatusOr<bool> restore_simulation(const CommandRecord& restore, SimulationState state,
                                          const std::string& spec_message, const RequestKey& request) override;
  absl::Status cut_series(const std::string& id, uint64_t last_step) override;

  absl::StatusOr<Owner> owner_of_patient(const std::string& id) override;
  absl::StatusOr<Owner> owner_of_simulation(const std::string& id) override;

  absl::StatusOr<std::optional<std::string>> find_request(const RequestKey& request) override;

  absl::Status note_draft(const std::string& path) override;
  absl::StatusOr<std::vector<TemporaryFile>> list_temporary_files() override;
  absl::Status forget_temporary_files(const std::vector<std::string>& paths) override;

  const Database& database() const { return *database_; }
  /// The id that the store was made with, and how often it was opened to be served.
  absl::StatusOr<StoreIdentity> read_identity();
  absl::Status set_starts(uint64_t starts);
  /// From now on the records of a simulation are written only while this daemon, which has joined
  /// others, owns it, see OwnerFence. `ownership` outlives this.
  void fence_by(Ownership& ownership) { fence_.raise(ownership); }
  /// Null where this daemon alone has the database.
  Ownership* ownership() const { return fence_.ownership(); }

 private:
  /// Carries out as one transaction what a request makes, or changes, once: `name` is remembered
  /// with it. The name that an equal request is remembered with, and nothing is done, where there
  /// was one.
  absl::StatusOr<std::optional<std::string>> transact_once(const RequestKey& request, const std::string& name,
                                                           const std::function<absl::Status()>& work);

  /// `origin`: the checkpoint it begins from, if any.
  absl::StatusOr<SimulationRecord> make_simulation(const SimulationRecord& simulation, const CheckpointRecord* origin,
                                                   const RequestKey& request);

  /// The following are called in a transaction.
  absl::StatusOr<PatientRecord> read_patient(const std::string& id);
  absl::StatusOr<ScanRecord> read_scan(const std::string& patient, const std::string& id);
  absl::StatusOr<ModelRecord> read_model(const std::string& patient, const std::string& id);
  absl::StatusOr<SimulationRecord> read_simulation(const std::string& id);
  absl::StatusOr<CheckpointRecord> read_checkpoint(const std::string& simulation, const std::string& id);
  /// The number of the last command that a simulation took; 0 before any.
  absl::StatusOr<uint64_t> read_last_command(const std::string& simulation);
  absl::Status write_patient(const PatientRecord& patient);
  absl::Status write_scan(const ScanRecord& scan);
  absl::Status write_model(const ModelRecord& model);
  /// Returns OK unless it has scans, models or plans.
  absl::Status check_empty(const std::string& patient);
  absl::Status write_simulation(const SimulationRecord& simulation);
  absl::Status write_command(const CommandRecord& command);
  absl::Status write_restore(const CommandRecord& restore, SimulationState state, const std::string& spec_message);
  absl::Status write_checkpoint(const CheckpointRecord& checkpoint);
  absl::Status write_state(const std::string& simulation, SimulationState state, const std::string& spec_message);
  absl::Status write_rows(const std::string& simulation, const SeriesChunk& rows);
  absl::Status erase_rows(const std::string& simulation, uint64_t last_step);
  /// Returns OK unless a simulation that has not ended runs on a model in [first, last):
  /// FAILED_PRECONDITION naming it.
  absl::Status check_unused(const std::string& first_model, const std::string& last_model);
  absl::Status write_labels(const PatientRecord& patient);
  absl::StatusOr<std::optional<std::string>> read_request(const RequestKey& request);
  absl::Status write_request(const RequestKey& request, const std::string& name);
  /// Forgets requests that made the resource `name` or something below it.
  absl::Status forget_requests(const std::string& name);

  const std::unique_ptr<Database> database_;
  Transactor turns_{*database_};
  OwnerFence fence_{*database_};
  /// The owners of simulations, which never change, as every call asks for one: to look into a
  /// record is to sum all of it, and plans may be long. Empty where another daemon may delete a
  /// simulation and make another of its name.
  std::map<std::string, Owner> owners_;
};

}  // namespace lipofill::server
