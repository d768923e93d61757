#pragma once

#include <string>
#include <vector>

#include "server/ops/metrics.h"
#include "server/sessions/session_manager.h"
#include "server/sessions/session_sink.h"
#include "server/store/checkpoint_files.h"
#include "server/store/store.h"
#include "server/store/temporary_files.h"

namespace lipofill::server {

/// Bounds of the checkpoints that are kept.
struct CheckpointOptions {
  double interval_s = 10.0;                 ///< wall time between automatic ones; 0: none
  int kept = 3;                             ///< automatic ones a simulation
  int most_asked = 32;                      ///< ones made by clients, a simulation
  uint64_t most_bytes = uint64_t{8} << 30;  ///< all results together take no more
};

/// Puts what sessions do and compute into the store, as messages of the wire schema, and lets go of
/// sessions that have ended. Counts what they do.
class ResultKeeper : public SessionSink {
 public:
  ResultKeeper(Store& store, CheckpointFiles& files, TemporaryFiles& temporary, SessionManager& sessions,
               const CheckpointOptions& options, Metrics& metrics)
      : store_(store),
        files_(files),
        temporary_(temporary),
        sessions_(sessions),
        options_(options),
        metrics_(metrics) {}
  absl::StatusOr<bool> was_kept(const RequestKey& request) override;
  absl::StatusOr<bool> keep_command(const CommandRecord& command, const RequestKey& request) override;
  absl::StatusOr<bool> keep_injection(const CommandRecord& command, double start_s, const RequestKey& request) override;
  absl::StatusOr<bool> keep_restore(const CommandRecord& command, SimulationState state,
                                    const std::string& spec_message, const RequestKey& request) override;
  absl::StatusOr<uint64_t> begin_epoch(const std::string& id) override;
  /// Keeps a checkpoint. RESOURCE_EXHAUSTED naming the bound when there are too many, or too many
  /// bytes.
  absl::StatusOr<CheckpointRecord> keep_checkpoint(const CheckpointRecord& draft, const std::string& snapshot,
                                                   const std::vector<SeriesEntry>& rows,
                                                   const RequestKey& request) override;
  absl::Status append_series(const std::string& id, const std::vector<SeriesEntry>& rows) override;
  void stepped(const SeriesEntry& entry) override;
  absl::Status parked(const std::string& id, const SessionView& view) override;
  absl::Status ended(const std::string& id, const SessionView& view, const Topology& topology,
                     const Frame& frame) override;

  /// Returns OK when files of so many bytes more are within the bound.
  absl::Status check_room(uint64_t bytes) const;

 private:
  absl::StatusOr<CheckpointRecord> write_checkpoint(const CheckpointRecord& draft, const std::string& snapshot,
                                                    const std::vector<SeriesEntry>& rows, const RequestKey& request);
  absl::StatusOr<CheckpointRecord> write_noted(const CheckpointRecord& draft, const std::string& spec_message,
                                               const std::string& snapshot, const std::vector<SeriesEntry>& rows,
                                               const RequestKey& request);
  absl::StatusOr<std::string> plan_as_of(const SimulationRecord& simulation, uint64_t last_command) const;
  absl::Status check_number_asked(const std::string& simulation) const;

  Store& store_;
  CheckpointFiles& files_;
  TemporaryFiles& temporary_;
  SessionManager& sessions_;
  const CheckpointOptions options_;
  Metrics& metrics_;
};

}  // namespace lipofill::server
