#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/store/sqlite.h"
#include "server/store/store.h"

namespace lipofill::server {

/// The store in one SQLite file: write-ahead log, foreign keys, a schema with a version (PRAGMA user_version). One
/// connection, its users take turns; calls last some ten microseconds.
class SqliteStore : public Store {
 public:
  /// DATA_LOSS for a file that is no database, FAILED_PRECONDITION for one of another program or of a newer schema.
  static absl::StatusOr<std::unique_ptr<SqliteStore>> open(const std::string& path);

  absl::StatusOr<PatientRecord> create_patient(const PatientRecord& patient, const RequestKey& request) override;
  absl::StatusOr<PatientRecord> get_patient(const std::string& id) override;
  absl::StatusOr<std::vector<PatientRecord>> list_patients(const Page& page) override;
  absl::Status update_patient(const PatientRecord& patient) override;
  absl::Status delete_patient(const std::string& id, bool force) override;

  absl::StatusOr<ScanRecord> create_scan(const ScanRecord& scan, const RequestKey& request) override;
  absl::StatusOr<ScanRecord> get_scan(const std::string& patient, const std::string& id) override;
  absl::StatusOr<std::vector<ScanRecord>> list_scans(const std::string& patient, const Page& page) override;
  absl::Status set_scan_received(const std::string& patient, const std::string& id, uint64_t bytes) override;
  absl::Status complete_scan(const std::string& patient, const std::string& id,
                             const std::string& report_message) override;
  absl::Status delete_scan(const std::string& patient, const std::string& id) override;

  absl::StatusOr<ModelRecord> create_model(const ModelRecord& model, const RequestKey& request) override;
  absl::StatusOr<ModelRecord> get_model(const std::string& patient, const std::string& id) override;
  absl::StatusOr<std::vector<ModelRecord>> list_models(const std::string& patient, const Page& page) override;
  absl::Status delete_model(const std::string& patient, const std::string& id) override;

  absl::StatusOr<SimulationRecord> create_simulation(const SimulationRecord& simulation,
                                                     const RequestKey& request) override;
  absl::StatusOr<SimulationRecord> get_simulation(const std::string& id) override;
  absl::StatusOr<std::vector<SimulationRecord>> list_simulations(const Page& page) override;
  absl::Status update_simulation_spec(const std::string& id, const std::string& spec_message) override;
  absl::Status end_simulation(const SimulationRecord& ended, const SimulationResult& result) override;
  absl::Status append_series(const std::string& id, const SeriesChunk& chunk) override;
  absl::StatusOr<std::optional<SeriesChunk>> next_series_chunk(const std::string& id, uint64_t after_step) override;
  absl::StatusOr<SimulationResult> get_result(const std::string& id) override;
  absl::Status delete_simulation(const std::string& id) override;
  absl::StatusOr<int> fail_unended_simulations(const std::string& reason) override;

  absl::StatusOr<std::optional<std::string>> find_request(const RequestKey& request) override;

 private:
  explicit SqliteStore(std::unique_ptr<Database> database) : database_(std::move(database)) {}

  /// The following are called with the mutex held.
  absl::StatusOr<PatientRecord> read_patient(const std::string& id);
  absl::StatusOr<ScanRecord> read_scan(const std::string& patient, const std::string& id);
  absl::StatusOr<ModelRecord> read_model(const std::string& patient, const std::string& id);
  absl::StatusOr<SimulationRecord> read_simulation(const std::string& id);
  absl::Status write_labels(const PatientRecord& patient);
  absl::StatusOr<std::optional<std::string>> read_request(const RequestKey& request);
  absl::Status write_request(const RequestKey& request, const std::string& name);
  /// Forgets requests that made the resource `name` or something below it.
  absl::Status forget_requests(const std::string& name);

  std::mutex mutex_;
  std::unique_ptr<Database> database_;
};

/// Names as on the wire; requests remember them.
std::string patient_name(const std::string& patient);
std::string scan_name(const std::string& patient, const std::string& scan);
std::string model_name(const std::string& patient, const std::string& model);
std::string simulation_name(const std::string& simulation);

}  // namespace lipofill::server
