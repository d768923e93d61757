#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "server/sessions/session_sink.h"

namespace lipofill::server {

/// Rows of a simulation's time series on their way to the sink. A row leaves only once it is there,
/// so that a reader who looks here first and there next misses none. Thread-safe; rows are added
/// and handed on by one thread at a time.
///
/// Checked by tests/unit/server/sessions/pending_series_test.cc.
class PendingSeries {
 public:
  /// That many rows are handed on at once.
  static constexpr size_t kChunk = 500;
  /// That many rows wait for room in the sink; more are lost.
  static constexpr size_t kMost = 100'000;

  PendingSeries(std::string simulation, SessionSink& sink) : simulation_(std::move(simulation)), sink_(sink) {}

  /// Adds the row of the last step, and hands all on when they fill a chunk.
  void add(SeriesEntry row);
  /// Rows of later steps, in order.
  std::vector<SeriesEntry> after(uint64_t step) const;
  /// Hands all on. What the sink says where it cannot keep them: they stay then.
  absl::Status flush();
  /// Forgets the first rows, which are kept elsewhere or of a future that was left.
  void forget(size_t n_rows);

 private:
  const std::string simulation_;
  SessionSink& sink_;
  mutable std::mutex mutex_;
  std::vector<SeriesEntry> rows_;
};

}  // namespace lipofill::server
