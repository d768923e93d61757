#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "server/store/scope.h"

namespace lipofill::server {

/// The records that the store keeps, as plain values. Fields called *_message hold serialised
/// messages of the wire schema that the store does not look into. Times are microseconds since
/// 1970.

struct PatientRecord {
  std::string id;
  std::string display_name;
  std::map<std::string, std::string> labels;
  int64_t create_time_us = 0;
  std::string tenant = kLocalTenant;
  bool is_damaged = false;  ///< in a list: it is not what was written, and no more than its id is told
};

struct ScanRecord {
  std::string patient;
  std::string id;
  int format = 0;  ///< has the number of the wire schema
  int unit = 0;    ///< has the number of the wire schema
  uint64_t size_bytes = 0;
  std::string sha256;
  uint64_t received_bytes = 0;
  bool complete = false;
  std::string report_message;
  int64_t create_time_us = 0;
  bool is_damaged = false;  ///< in a list: it is not what was written, and no more than its id is told
};

struct ModelRecord {
  std::string patient;
  std::string id;
  std::string scan;  ///< id of the scan it was built from, empty for a square
  std::string content_hash;
  std::string spec_message;
  std::string report_message;
  int64_t create_time_us = 0;
  std::string bone_scan;    ///< id of the scan of the bone it was built from, empty without one
  bool is_damaged = false;  ///< in a list: it is not what was written, and no more than its id is told
};

enum class SimulationState { kReady = 1, kRunning, kPaused, kSettled, kFinished, kStopped, kFailed };

inline bool has_ended(SimulationState state) {
  return state >= SimulationState::kSettled;
}

inline const char* state_name(SimulationState state) {
  constexpr const char* kNames[] = {"", "READY", "RUNNING", "PAUSED", "SETTLED", "FINISHED", "STOPPED", "FAILED"};
  return kNames[static_cast<int>(state)];
}

struct SimulationRecord {
  std::string id;
  std::string model;  ///< patients/{patient}/models/{model}
  std::string display_name;
  std::string spec_message;
  SimulationState state = SimulationState::kReady;
  std::string reason;
  std::string summary_message;
  int64_t create_time_us = 0;
  std::string origin = {};    ///< simulations/{simulation}/checkpoints/{checkpoint} it began from; empty: from its plan
  uint64_t last_command = 0;  ///< number of the last command it took; given by the store
  std::string tenant = kLocalTenant;
  bool is_damaged = false;  ///< in a list: it is not what was written, and no more than its id is told
};

/// A client's command. Those that set the state are told by it: start and resume RUNNING, pause
/// PAUSED.
enum class CommandKind { kStart = 1, kPause, kResume, kStop, kInject, kRestore };

/// One acknowledged command, in the order they took effect. A command is on course unless its
/// simulation was restored to a state before it.
struct CommandRecord {
  std::string simulation;
  uint64_t number = 0;  ///< 1, 2, ...; given by the store
  CommandKind kind = CommandKind::kStart;
  uint64_t step = 0;    ///< it took effect after this step
  std::string payload;  ///< kInject: the injection; kStop: the reason; kRestore: the checkpoint's id
  int64_t create_time_us = 0;
};

/// kAutomatic: made by the daemon, gone with the run. kAsked: made by a client. kOrigin: what a
/// simulation began from.
enum class CheckpointKind { kAutomatic = 1, kAsked, kOrigin };

/// A state of a simulation, kept in a file.
struct CheckpointRecord {
  std::string simulation;
  std::string id;
  CheckpointKind kind = CheckpointKind::kAutomatic;
  bool on_course = true;  ///< the simulation has not since been restored to a state before it
  uint64_t step = 0;
  double time_s = 0.0;        ///< simulated
  double wall_s = 0.0;        ///< spent RUNNING until then
  uint64_t last_command = 0;  ///< number of the last command that is in the state; 0: the store gives the last it has
  uint64_t size_bytes = 0;    ///< is that of the file
  std::string sha256;         ///< is computed from the file's body
  std::string state_hash;
  int64_t create_time_us = 0;
  bool is_damaged = false;  ///< in a list: it is not what was written, and no more than its id is told
};

/// The data that a viewer of an ended simulation is shown.
struct SimulationResult {
  std::string meshes_message;
  std::string frame_message;
};

/// Consecutive rows of a simulation's series.
struct SeriesChunk {
  uint64_t first_step = 0;
  uint64_t last_step = 0;
  std::string rows_message;
};

/// An identity is what tells one store from another, and an older state of it from a newer one.
struct StoreIdentity {
  std::string id;       ///< 32 hexadecimal digits
  uint64_t starts = 0;  ///< how often it was opened to be served
};

/// A file that may be removed, by its path below the data directory.
struct TemporaryFile {
  std::string path;       ///< scans/{patient}/{scan} or checkpoints/{simulation}/{checkpoint}
  bool is_draft = false;  ///< is being written; else its record was deleted
};

/// Makes a create idempotent: the same method and id again, by the same tenant, give the resource
/// made the first time. Empty id: no such promise.
struct RequestKey {
  std::string method;
  std::string id;
  std::string fingerprint;  ///< tells the whole request: one id for two requests is the caller's mistake
  std::string tenant = kLocalTenant;
};

/// The `size` records that follow `after` in ascending order of their ids.
struct Page {
  std::string after;
  int size = 100;
};

}  // namespace lipofill::server
