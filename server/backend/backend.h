#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"
#include "server/backend/awaited_simulations.h"
#include "server/backend/result_keeper.h"
#include "server/backend/size_limits.h"
#include "server/ops/metrics.h"
#include "server/sessions/courier.h"
#include "server/sessions/model_cache.h"
#include "server/sessions/operations.h"
#include "server/sessions/session_manager.h"
#include "server/sessions/shape_desk.h"
#include "server/sessions/task_pool.h"
#include "server/sessions/worker_pool.h"
#include "server/store/checkpoint_files.h"
#include "server/store/scan_files.h"
#include "server/store/space_reserve.h"
#include "server/store/store.h"
#include "server/store/temporary_files.h"

namespace lipofill::server {

struct BackendOptions {
  int workers = 1;
  int max_running = 16;
  SessionBounds sessions;
  SizeLimits sizes;
  /// A client that has been silent for so long is asked whether it is there, and dropped when it
  /// does not answer in time.
  double keepalive_s = 30.0;
  double keepalive_timeout_s = 20.0;
  int max_viewers = 1000;
  uint64_t viewer_bytes = uint64_t{512} << 20;  ///< frames that they have yet to read
  CheckpointOptions checkpoints;
  uint64_t reserve_bytes = 0;  ///< room that is kept back for deletions
};

/// Everything that the services share.
struct Backend {
  Backend(const BackendOptions& the_options, Store& the_store, ScanFiles& scans, CheckpointFiles& checkpoints,
          Metrics& the_metrics)
      : options(the_options),
        store(the_store),
        scan_files(scans),
        checkpoint_files(checkpoints),
        metrics(the_metrics),
        temporary_files(the_store, scans.files().root().parent_path()),
        reserve(scans.files().root().parent_path() / "reserve", options.reserve_bytes),
        sessions(options.sessions),
        keeper(the_store, checkpoints, temporary_files, sessions, options.checkpoints, the_metrics),
        workers(options.workers, static_cast<size_t>(options.max_running)) {}

  const BackendOptions options;
  Store& store;
  ScanFiles& scan_files;
  CheckpointFiles& checkpoint_files;
  Metrics& metrics;
  TemporaryFiles temporary_files;
  SpaceReserve reserve;
  std::atomic<bool> stopping = false;
  /// This is held while a simulation that is not in memory is brought back or deleted: one at a
  /// time.
  std::mutex waking;
  AwaitedSimulations awaited;
  ModelCache models{8};
  Operations operations;
  SessionManager sessions;
  ResultKeeper keeper;
  Courier courier;
  ShapeDesk shapes{workers, sessions};
  /// These come last: their threads use the others.
  WorkerPool workers;
  TaskPool calls{"calls", 2, 256};
  TaskPool builds{"builds", 2, 64};

  /// The model of a record, from memory or built again from its specification and scan. DATA_LOSS
  /// when what is built is not what the record says.
  absl::StatusOr<ModelCache::Model> load_model(const std::string& name);

  /// Takes the locks that the daemon's threads share, and returns only if it gets them: a sign of
  /// life.
  void check_alive() const;
};

}  // namespace lipofill::server
