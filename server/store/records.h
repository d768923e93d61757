#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace lipofill::server {

/// What the store keeps, as plain values. Fields called *_message hold serialised messages of the wire schema that the
/// store does not look into. Times are microseconds since 1970.

struct PatientRecord {
  std::string id;
  std::string display_name;
  std::map<std::string, std::string> labels;
  int64_t create_time_us = 0;
};

struct ScanRecord {
  std::string patient;
  std::string id;
  int format = 0;  ///< as in the wire schema
  int unit = 0;    ///< as in the wire schema
  uint64_t size_bytes = 0;
  std::string sha256;
  uint64_t received_bytes = 0;
  bool complete = false;
  std::string report_message;
  int64_t create_time_us = 0;
};

struct ModelRecord {
  std::string patient;
  std::string id;
  std::string scan;  ///< id of the scan it was built from, empty for a square
  std::string content_hash;
  std::string spec_message;
  std::string report_message;
  int64_t create_time_us = 0;
  std::string bone_scan;  ///< id of the scan of the bone it was built from, empty without one
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
};

/// What a viewer of an ended simulation is shown.
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

/// Makes a create idempotent: the same method and id again give the resource made the first time. Empty id: no such
/// promise.
struct RequestKey {
  std::string method;
  std::string id;
  std::string fingerprint;  ///< of the whole request: the same id with another request is a mistake of the caller
};

/// The `size` records that follow `after` in ascending order of their ids.
struct Page {
  std::string after;
  int size = 100;
};

}  // namespace lipofill::server
