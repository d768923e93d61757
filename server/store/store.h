#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/operation_store.h"
#include "server/store/plan_store.h"
#include "server/store/records.h"

namespace lipofill::server {

/// Patients, scans (their records, not their bytes), models, plans, long-running operations,
/// simulations and their results, durable and transactional: every call either happens whole or not
/// at all. All calls may come from any thread.
///
/// Errors: NOT_FOUND and ALREADY_EXISTS naming the resource, FAILED_PRECONDITION, INVALID_ARGUMENT
/// for a request id that was used for another request, DATA_LOSS and UNAVAILABLE from the medium.
/// Checked by tests/unit/server/store/store_test.cc.
class Store : public PlanStore, public OperationStore {
 public:
  /// Creates return the record now in the store: the one given, or the one an equal request made
  /// before.
  virtual absl::StatusOr<PatientRecord> create_patient(const PatientRecord& patient, const RequestKey& request) = 0;
  virtual absl::StatusOr<PatientRecord> get_patient(const std::string& id) = 0;
  /// Lists the patients within the scope.
  virtual absl::StatusOr<std::vector<PatientRecord>> list_patients(const Scope& scope, const Page& page) = 0;
  /// Replaces display name and labels by what `change` makes of the present record; nobody comes
  /// between. What `change` refuses is not done.
  using PatientChange = std::function<absl::StatusOr<PatientRecord>(const PatientRecord& present)>;
  virtual absl::StatusOr<PatientRecord> update_patient(const std::string& id, const PatientChange& change) = 0;
  /// Deletes a patient. FAILED_PRECONDITION while it has scans, models or plans, unless `force` is
  /// given; then they go too. `check`, if any, may refuse.
  using PatientCheck = std::function<absl::Status(const PatientRecord& present)>;
  virtual absl::Status delete_patient(const std::string& id, bool force, const PatientCheck& check = nullptr) = 0;

  virtual absl::StatusOr<ScanRecord> create_scan(const ScanRecord& scan, const RequestKey& request) = 0;
  virtual absl::StatusOr<ScanRecord> get_scan(const std::string& patient, const std::string& id) = 0;
  virtual absl::StatusOr<std::vector<ScanRecord>> list_scans(const std::string& patient, const Page& page) = 0;
  /// Lists the scans of every patient of which bytes have yet to come.
  virtual absl::StatusOr<std::vector<ScanRecord>> list_incomplete_scans() = 0;
  virtual absl::Status set_scan_received(const std::string& patient, const std::string& id, uint64_t bytes) = 0;
  virtual absl::Status complete_scan(const std::string& patient, const std::string& id,
                                     const std::string& report_message) = 0;
  /// Deletes a scan. FAILED_PRECONDITION while a model was built from it, or a plan names it.
  virtual absl::Status delete_scan(const std::string& patient, const std::string& id) = 0;

  virtual absl::StatusOr<ModelRecord> create_model(const ModelRecord& model, const RequestKey& request) = 0;
  virtual absl::StatusOr<ModelRecord> get_model(const std::string& patient, const std::string& id) = 0;
  virtual absl::StatusOr<std::vector<ModelRecord>> list_models(const std::string& patient, const Page& page) = 0;
  /// Deletes a model. FAILED_PRECONDITION while a simulation that has not ended runs on it; so does
  /// deleting its patient.
  virtual absl::Status delete_model(const std::string& patient, const std::string& id) = 0;

  virtual absl::StatusOr<SimulationRecord> create_simulation(const SimulationRecord& simulation,
                                                             const RequestKey& request) = 0;
  virtual absl::StatusOr<SimulationRecord> get_simulation(const std::string& id) = 0;
  virtual absl::StatusOr<std::vector<SimulationRecord>> list_simulations(const Scope& scope, const Page& page) = 0;
  /// Keeps state, reason, summary and result in one go; automatic checkpoints go.
  virtual absl::Status end_simulation(const SimulationRecord& ended, const SimulationResult& result) = 0;
  /// Keeps state and reason alone, without a result.
  virtual absl::Status set_simulation_state(const std::string& id, SimulationState state,
                                            const std::string& reason) = 0;
  /// Keeps the figures of a simulation that has not ended and is at rest; empty when it is in
  /// memory again.
  virtual absl::Status keep_summary(const std::string& id, const std::string& summary_message) = 0;
  virtual absl::Status append_series(const std::string& id, const SeriesChunk& chunk) = 0;
  /// The chunk that holds the first step after `after_step`; none when there is no later one.
  virtual absl::StatusOr<std::optional<SeriesChunk>> next_series_chunk(const std::string& id, uint64_t after_step) = 0;
  /// Returns the result. FAILED_PRECONDITION when it ended without one.
  virtual absl::StatusOr<SimulationResult> get_result(const std::string& id) = 0;
  virtual absl::Status delete_simulation(const std::string& id) = 0;
  /// Lists the simulations that have not ended, in order of their ids.
  virtual absl::StatusOr<std::vector<SimulationRecord>> list_unended_simulations() = 0;
  /// A number for a new stream of frames: `now_us`, or more, so that it is larger than any before.
  virtual absl::StatusOr<uint64_t> begin_epoch(const std::string& id, int64_t now_us) = 0;

  /// Keeps a command, the state it leads to and, where one is given, the plan it makes. False when
  /// an equal request was kept before: nothing is changed then.
  virtual absl::StatusOr<bool> append_command(const CommandRecord& command, const std::string& spec_message,
                                              const RequestKey& request) = 0;
  /// The commands on course, in order.
  virtual absl::StatusOr<std::vector<CommandRecord>> list_commands(const std::string& simulation) = 0;

  /// Records a checkpoint whose file is there, together with the rows of the series up to it.
  /// ALREADY_EXISTS for an id in use.
  virtual absl::StatusOr<CheckpointRecord> create_checkpoint(const CheckpointRecord& checkpoint,
                                                             const std::optional<SeriesChunk>& rows,
                                                             const RequestKey& request) = 0;
  virtual absl::StatusOr<CheckpointRecord> get_checkpoint(const std::string& simulation, const std::string& id) = 0;
  virtual absl::StatusOr<std::vector<CheckpointRecord>> list_checkpoints(const std::string& simulation,
                                                                         const Page& page) = 0;
  /// Deletes a checkpoint. FAILED_PRECONDITION for the one that a simulation which has not ended
  /// began from.
  virtual absl::Status delete_checkpoint(const std::string& simulation, const std::string& id) = 0;
  /// Deletes automatic checkpoints except the `newest` on course.
  virtual absl::Status prune_checkpoints(const std::string& simulation, int newest) = 0;
  virtual absl::StatusOr<uint64_t> count_checkpoint_bytes() = 0;

  /// A simulation that begins from a checkpoint of its own, whose file is there.
  virtual absl::StatusOr<SimulationRecord> create_simulation_from(const SimulationRecord& simulation,
                                                                  const CheckpointRecord& origin,
                                                                  const RequestKey& request) = 0;
  /// Takes a simulation back to a checkpoint on its course: what came after, commands, checkpoints
  /// and rows of the series, leaves the course; `state` and `spec_message` are those it goes on
  /// with. False as in append_command; FAILED_PRECONDITION for a checkpoint that is not on course.
  virtual absl::StatusOr<bool> restore_simulation(const CommandRecord& restore, SimulationState state,
                                                  const std::string& spec_message, const RequestKey& request) = 0;
  /// Forgets rows of the series after a step.
  virtual absl::Status cut_series(const std::string& id, uint64_t last_step) = 0;

  /// The owner of a resource; for a simulation the patient of its model, which may have been
  /// deleted since.
  virtual absl::StatusOr<Owner> owner_of_patient(const std::string& id) = 0;
  virtual absl::StatusOr<Owner> owner_of_simulation(const std::string& id) = 0;

  /// Files that may be removed, because no record speaks of them yet, or any more. Whoever writes a
  /// checkpoint's file notes it first; its record takes the note away, and deleting the record of a
  /// scan or a checkpoint makes one.
  virtual absl::Status note_draft(const std::string& path) = 0;
  virtual absl::StatusOr<std::vector<TemporaryFile>> list_temporary_files() = 0;
  /// Forgets files that are gone.
  virtual absl::Status forget_temporary_files(const std::vector<std::string>& paths) = 0;

  /// The name an earlier, equal request made, if any.
  virtual absl::StatusOr<std::optional<std::string>> find_request(const RequestKey& request) = 0;
};

}  // namespace lipofill::server
