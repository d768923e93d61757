#pragma once

namespace lipofill::server {

// The tables of the newest schema, the same in every kind of database: to_postgres() makes those of
// PostgreSQL of them.

/// Ids are compared as bytes; requests hold the full name of what they made. Columns stand in the
/// order in which the changes of the schema bring them.
inline constexpr char kSchema[] = R"(
CREATE TABLE patients (
  id BLOB PRIMARY KEY, display_name BLOB NOT NULL, create_time_us INTEGER NOT NULL,
  tenant BLOB NOT NULL DEFAULT x'6c6f63616c') WITHOUT ROWID;
CREATE TABLE patient_labels (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, key BLOB NOT NULL, value BLOB NOT NULL,
  PRIMARY KEY (patient, key)) WITHOUT ROWID;
CREATE TABLE scans (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, id BLOB NOT NULL, format INTEGER NOT NULL,
  unit INTEGER NOT NULL, size_bytes INTEGER NOT NULL, sha256 BLOB NOT NULL, received_bytes INTEGER NOT NULL,
  complete INTEGER NOT NULL, report BLOB NOT NULL, create_time_us INTEGER NOT NULL, PRIMARY KEY (patient, id));
CREATE TABLE models (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, id BLOB NOT NULL, scan BLOB NOT NULL,
  content_hash BLOB NOT NULL, spec BLOB NOT NULL, report BLOB NOT NULL, create_time_us INTEGER NOT NULL,
  bone_scan BLOB NOT NULL DEFAULT x'', PRIMARY KEY (patient, id));
CREATE TABLE simulations (
  id BLOB PRIMARY KEY, model BLOB NOT NULL, display_name BLOB NOT NULL, spec BLOB NOT NULL, state INTEGER NOT NULL,
  reason BLOB NOT NULL, summary BLOB NOT NULL, create_time_us INTEGER NOT NULL, epoch INTEGER NOT NULL DEFAULT 0,
  origin BLOB NOT NULL DEFAULT x'', tenant BLOB NOT NULL DEFAULT x'6c6f63616c');
CREATE TABLE simulation_results (
  simulation BLOB PRIMARY KEY REFERENCES simulations(id) ON DELETE CASCADE, meshes BLOB NOT NULL, frame BLOB NOT NULL);
CREATE TABLE simulation_series (
  simulation BLOB NOT NULL REFERENCES simulations(id) ON DELETE CASCADE, first_step INTEGER NOT NULL,
  last_step INTEGER NOT NULL, rows BLOB NOT NULL, PRIMARY KEY (simulation, last_step));
CREATE TABLE requests (
  tenant BLOB NOT NULL, method BLOB NOT NULL, id BLOB NOT NULL, fingerprint BLOB NOT NULL, name BLOB NOT NULL,
  PRIMARY KEY (tenant, method, id)) WITHOUT ROWID;
CREATE INDEX requests_by_name ON requests(name);
)";

/// The log of commands, and checkpoints.
inline constexpr char kResumeTables[] = R"(
CREATE TABLE simulation_commands (
  simulation BLOB NOT NULL REFERENCES simulations(id) ON DELETE CASCADE, number INTEGER NOT NULL,
  kind INTEGER NOT NULL, step INTEGER NOT NULL, payload BLOB NOT NULL, on_course INTEGER NOT NULL,
  create_time_us INTEGER NOT NULL, PRIMARY KEY (simulation, number)) WITHOUT ROWID;
CREATE TABLE checkpoints (
  simulation BLOB NOT NULL REFERENCES simulations(id) ON DELETE CASCADE, id BLOB NOT NULL, kind INTEGER NOT NULL,
  on_course INTEGER NOT NULL, step INTEGER NOT NULL, time_s REAL NOT NULL, wall_s REAL NOT NULL,
  last_command INTEGER NOT NULL, size_bytes INTEGER NOT NULL, sha256 BLOB NOT NULL, state_hash BLOB NOT NULL,
  create_time_us INTEGER NOT NULL, PRIMARY KEY (simulation, id));
)";

inline constexpr char kTenantIndexes[] = R"(
CREATE INDEX patients_by_tenant ON patients(tenant, id);
CREATE INDEX simulations_by_tenant ON simulations(tenant, id);
)";

/// The id of the store and how often it was opened to be served; files that may be removed.
inline constexpr char kStoreTables[] = R"(
CREATE TABLE store (id BLOB NOT NULL, starts INTEGER NOT NULL);
CREATE TABLE temporary_files (path BLOB PRIMARY KEY, is_draft INTEGER NOT NULL) WITHOUT ROWID;
)";

/// 6: plans, their revisions, and what was run from them.
inline constexpr char kPlanTables[] = R"(
CREATE TABLE plans (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, id BLOB NOT NULL, revision INTEGER NOT NULL,
  scan BLOB NOT NULL, target BLOB NOT NULL, content BLOB NOT NULL, create_time_us INTEGER NOT NULL,
  update_time_us INTEGER NOT NULL, PRIMARY KEY (patient, id));
CREATE TABLE plan_revisions (
  patient BLOB NOT NULL, plan BLOB NOT NULL, number INTEGER NOT NULL, content BLOB NOT NULL, changes BLOB NOT NULL,
  create_time_us INTEGER NOT NULL, PRIMARY KEY (patient, plan, number),
  FOREIGN KEY (patient, plan) REFERENCES plans(patient, id) ON DELETE CASCADE);
CREATE TABLE plan_runs (
  simulation BLOB PRIMARY KEY REFERENCES simulations(id) ON DELETE CASCADE, patient BLOB NOT NULL,
  plan BLOB NOT NULL, content_hash BLOB NOT NULL, create_time_us INTEGER NOT NULL,
  FOREIGN KEY (patient, plan) REFERENCES plans(patient, id) ON DELETE CASCADE);
CREATE INDEX plan_runs_by_plan ON plan_runs(patient, plan);
)";

/// 7: long-running operations that outlive the daemon, and their finished parts.
inline constexpr char kOperationTables[] = R"(
CREATE TABLE operations (
  id BLOB PRIMARY KEY, patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, tenant BLOB NOT NULL,
  method BLOB NOT NULL, request_id BLOB NOT NULL, fingerprint BLOB NOT NULL, request BLOB NOT NULL,
  done INTEGER NOT NULL, response BLOB NOT NULL, create_time_us INTEGER NOT NULL);
CREATE INDEX operations_by_patient ON operations(patient);
CREATE TABLE operation_parts (
  operation BLOB NOT NULL REFERENCES operations(id) ON DELETE CASCADE, number INTEGER NOT NULL,
  bytes BLOB NOT NULL, PRIMARY KEY (operation, number));
)";

}  // namespace lipofill::server
