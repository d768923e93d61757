// lipofilld: opens the store, serves until SIGTERM or SIGINT, drains.

#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/coupling/algebra_threads.h"
#include "server/backend/abandoned_uploads.h"
#include "server/backend/backend_metrics.h"
#include "server/backend/fleet_attendant.h"
#include "server/backend/parking.h"
#include "server/backend/recovery_attendant.h"
#include "server/backend/simulation_recovery.h"
#include "server/grpc_server.h"
#include "server/ops/connection_metrics.h"
#include "server/ops/drain_guard.h"
#include "server/ops/file_limit.h"
#include "server/ops/logging.h"
#include "server/ops/metrics_server.h"
#include "server/ops/options.h"
#include "server/ops/process_figures.h"
#include "server/ops/self_check.h"
#include "server/ops/service_manager.h"
#include "server/ops/signals.h"
#include "server/sessions/identifiers.h"
#include "server/store/backup.h"
#include "server/store/data_directory.h"
#include "server/store/ownership.h"
#include "server/store/store_opening.h"
#include "server/store/stray_files.h"
#include "server/store/temporary_files.h"
#include "server/store/verification.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// The exit code of a backup, a restore or a verification that found damage.
constexpr int kFoundDamage = 3;

/// Tells of each damage.
void tell(const std::vector<Damage>& damages) {
  for (const Damage& damage : damages) spdlog::error("{} is damaged: {}", damage.name, damage.what);
}

/// Removes what the store recorded as temporary, and sets files aside that it knows nothing of.
absl::Status tidy_files(Store& store, const ScanFiles& scans, const CheckpointFiles& checkpoints,
                        const DataDirectory& data) {
  const int swept = TemporaryFiles(store, data.path()).sweep();
  if (swept > 0) spdlog::info("{} temporary files were removed", swept);
  const auto strays = set_strays_aside(store, scans, checkpoints, data.path(), now_us());
  if (!strays.ok()) return strays.status();
  if (strays->files == 0) return absl::OkStatus();
  spdlog::warn(
      "{} files of which the database knows nothing were set aside, in {}. Nothing removes them: if they are missed, "
      "put the database that knows them in its place",
      strays->files, strays->place.string());
  return absl::OkStatus();
}

/// To open a store takes some room, for which what is kept back serves too.
absl::StatusOr<OpenedStore> open_store(const DataDirectory& data, const Options& options) {
  absl::StatusOr<OpenedStore> opened = absl::UnknownError("");
  SpaceReserve reserve(data.reserve(), options.space_reserve_mb * 1'000'000);
  const absl::Status done = reserve.spend([&opened, &data, &options] {
    opened = open_store_to_serve(data, options.database());
    return opened.status();
  });
  if (!done.ok()) return done;
  return opened;
}

/// The directory of a store, what is in it, and who else serves it.
struct Ground {
  std::optional<DataDirectory> data;
  std::unique_ptr<Ownership> ownership;  ///< null: the store is this daemon's alone
  OpenedStore opened;
  std::vector<DaemonRecord> others;
};

/// Opens a store that may be shared: daemons do so one after the other.
absl::Status open_shared(const Options& options, Ground& ground) {
  auto data = DataDirectory::open_shared(options.data, options.own_name());
  if (!data.ok()) return data.status();
  ground.data.emplace(*std::move(data));
  auto ownership = Ownership::open(options.store);
  if (!ownership.ok()) return ownership.status();
  ground.ownership = *std::move(ownership);
  if (absl::Status begun = ground.ownership->begin_start(); !begun.ok()) return begun;
  auto opened = open_store(*ground.data, options);
  if (!opened.ok()) return opened.status();
  ground.opened = *std::move(opened);
  auto others = ground.ownership->join(*ground.data, program_version());
  if (!others.ok()) return others.status();
  ground.others = *std::move(others);
  ground.opened.store->fence_by(*ground.ownership);
  for (const DaemonRecord& other : ground.others) {
    spdlog::info("{} serves the same store{}{}", other.name, other.address.empty() ? "" : " at ", other.address);
    if (other.version != program_version()) {
      spdlog::warn("{} is version {}, this is {}", other.name, other.version, program_version());
    }
  }
  return absl::OkStatus();
}

absl::Status open_ground(const Options& options, Ground& ground) {
  if (options.is_shared()) return open_shared(options, ground);
  auto data = DataDirectory::open(options.data);
  if (!data.ok()) return data.status();
  ground.data.emplace(*std::move(data));
  auto opened = open_store(*ground.data, options);
  if (opened.ok()) ground.opened = *std::move(opened);
  return opened.status();
}

/// The file is written beside and moved into place, so that a script never reads half a number.
absl::Status write_port(const std::string& path, int port) {
  const std::string draft = path + ".new";
  std::ofstream(draft) << port << "\n";
  std::error_code error;
  std::filesystem::rename(draft, path, error);
  return error ? absl::FailedPreconditionError("cannot write " + path + ": " + error.message()) : absl::OkStatus();
}

BackendOptions backend_options(const Options& options) {
  BackendOptions backend;
  backend.workers = options.workers;
  backend.max_running = options.max_running;
  backend.sessions.simulations = options.max_simulations;
  backend.sessions.simulations_per_tenant = options.max_simulations_per_tenant;
  backend.sessions.memory_bytes = options.simulation_memory_mb * 1'000'000;
  backend.sizes.upload_bytes = options.max_upload_mb * 1'000'000;
  backend.sizes.hexahedra = options.max_hexahedra;
  backend.sizes.film_cells = options.max_film_cells;
  backend.keepalive_s = options.keepalive_s;
  backend.keepalive_timeout_s = options.keepalive_timeout_s;
  backend.max_viewers = options.max_viewers;
  backend.viewer_bytes = options.viewer_memory_mb * 1'000'000;
  backend.checkpoints.interval_s = options.checkpoint_interval_s;
  backend.checkpoints.kept = options.checkpoints_kept;
  backend.reserve_bytes = options.space_reserve_mb * 1'000'000;
  backend.checkpoints.most_bytes = options.checkpoint_space_mb * 1'000'000;
  return backend;
}

/// Bounds connections by the settings, and by the files that this process may open.
DoorBounds door_bounds(const Options& options) {
  const size_t files = raise_file_limit();
  DoorBounds bounds;
  bounds.connections = std::min(static_cast<size_t>(options.max_connections), connections_within(files));
  bounds.connections_per_peer = static_cast<size_t>(options.max_connections_per_peer);
  bounds.unread = std::chrono::milliseconds(std::lround(1e3 * options.keepalive_timeout_s));
  if (bounds.connections < static_cast<size_t>(options.max_connections)) {
    spdlog::warn("max-connections is {}, but {} open files allow {}: raise LimitNOFILE or ulimit -n",
                 options.max_connections, files, bounds.connections);
  }
  return bounds;
}

/// Opens the audit log; nullptr when none is asked for.
absl::StatusOr<std::unique_ptr<AuditLog>> open_audit_log(const Options& options) {
  std::string path = options.security.audit_file_in(options.data);
  // Daemons that share a directory have a log each.
  if (options.is_shared() && options.security.audit_file.empty() && !path.empty()) {
    path = absl::StrCat(options.data, "/audit-", options.own_name(), ".jsonl");
  }
  if (path.empty()) return nullptr;
  std::shared_ptr<const AnchorKey> key;
  if (!options.security.audit_key_file.empty()) {
    auto opened = AnchorKey::open(options.security.audit_key_file);
    if (!opened.ok()) return opened.status();
    key = std::make_shared<const AnchorKey>(*std::move(opened));
  }
  return AuditLog::open(path, options.security.audit_rotate_mb * 1'000'000, std::move(key));
}

absl::StatusOr<std::unique_ptr<MetricsServer>> serve_metrics(const Options& options, const DoorFigures& door,
                                                             Backend& backend) {
  if (options.metrics_listen.empty()) return nullptr;
  add_process_metrics(backend.metrics);
  add_connection_metrics(door, backend.metrics);
  add_backend_metrics(backend, backend.metrics);
  auto server = MetricsServer::start(options.metrics_listen, backend.metrics);
  if (server.ok()) spdlog::info("metrics at {}, path /metrics (port {})", options.metrics_listen, (*server)->port());
  return server;
}

absl::Status serve_until_signal(const Options& options, const std::string& store_name, const Backend& backend,
                                GrpcServer& server) {
  if (!options.port_file.empty()) {
    if (auto written = write_port(options.port_file, server.port()); !written.ok()) return written;
  }
  const std::string where = absl::StrJoin(options.listen, ", ");
  const std::string port = server.port() > 0 ? absl::StrCat(" (port ", server.port(), ")") : "";
  spdlog::info("lipofilld serves {}{} with {} workers, data in {}{}", where, port, options.workers, options.data,
               options.store.empty() ? "" : absl::StrCat(", records in ", store_name));
  if (!coupling::has_pinned_kernels()) {
    spdlog::warn(
        "OpenBLAS computes with {} kernels, which cannot be pinned here: results differ from those of other "
        "machines in their last digits",
        coupling::algebra_kernels());
  }
  const ServiceManager manager;
  manager.tell_ready("serving " + where);
  const Ownership* const ownership = ownership_of(backend.store);
  const SelfCheck self_check(
      std::chrono::duration<double>(options.self_check_s),
      [&server, ownership] {
        return ownership == nullptr || ownership->is_held() ? server.check_reachable() : no_lease();
      },
      [&server](bool reachable) { server.set_reachable(reachable); });
  const int signal = wait_for_signal(manager.watchdog_period(), [&backend, &manager, &self_check] {
    backend.check_alive();
    if (self_check.is_good()) manager.tell_alive();
  });
  spdlog::info("signal {}: draining", signal);
  manager.tell_stopping();
  return absl::OkStatus();
}

absl::Status serve(const Options& options) {
  std::optional<DrainGuard> guard;  // first: it outlasts all that must end
  Ground ground;
  if (auto opened = open_ground(options, ground); !opened.ok()) return opened;
  if (!ground.opened.remark.empty()) spdlog::warn("{}", ground.opened.remark);
  Store& store = *ground.opened.store;
  const std::string& store_name = ground.opened.store->database().name();
  auto files = ScanFiles::open(ground.data->scans());
  if (!files.ok()) return files.status();
  auto checkpoints = CheckpointFiles::open(ground.data->checkpoints());
  if (!checkpoints.ok()) return checkpoints.status();
  // What others are writing has no record yet either.
  if (ground.others.empty()) {
    if (auto tidied = tidy_files(store, *files, *checkpoints, *ground.data); !tidied.ok()) return tidied;
  }
  if (ground.ownership != nullptr) ground.ownership->end_start();

  const auto authenticator = Authenticator::open(options.security);
  if (!authenticator.ok()) return authenticator.status();
  const auto audit = open_audit_log(options);
  if (!audit.ok()) return audit.status();
  Metrics metrics;
  Backend backend(backend_options(options), store, *files, *checkpoints, metrics);
  if (options.space_reserve_mb > 0 && !backend.reserve.fill()) {
    spdlog::warn("there is no room for the reserve of {} MB: on a full disk nothing can be deleted",
                 options.space_reserve_mb);
  }
  std::optional<FleetAttendant> fleet;  // first: to bring back may take longer than a lease lasts
  if (ground.ownership != nullptr) fleet.emplace(backend, *ground.ownership);
  if (auto back = bring_back_simulations(backend); !back.ok()) return back;
  const ParkingAttendant parking(backend, std::chrono::duration<double>(options.park_after_s));
  const RecoveryAttendant recovery(backend);
  const UploadAttendant uploads(backend, std::chrono::duration<double>(options.drop_uploads_after_s));
  const auto server =
      GrpcServer::start(options.listen, {options.security, **authenticator, audit->get(), options.reflection},
                        door_bounds(options), backend);
  if (!server.ok()) return server.status();
  if (ground.ownership != nullptr) {
    const std::string address = options.own_address((*server)->port());
    if (auto told = ground.ownership->announce(address); !told.ok()) return told;
    spdlog::info("this daemon is {}, called at {}", ground.ownership->name(), address);
  }
  const auto metrics_server = serve_metrics(options, (*server)->door_figures(), backend);
  const absl::Status served =
      metrics_server.ok() ? serve_until_signal(options, store_name, backend, **server) : metrics_server.status();
  guard.emplace(options.drain_timeout_s);
  const bool drained =
      (*server)->drain(GrpcServer::Seconds(options.drain_delay_s), GrpcServer::Seconds(options.drain_timeout_s));
  if (ground.ownership != nullptr) ground.ownership->leave();
  spdlog::info("stopped");
  if (!drained) std::_Exit(served.ok() ? 0 : 1);
  return served;
}

/// Calls `tell` at most once a second.
template <typename Tell>
auto each_second(Tell tell) {
  using Clock = std::chrono::steady_clock;
  return [tell, told = Clock::now()](const auto& so_far) mutable {
    if (Clock::now() - told < std::chrono::seconds(1)) return;
    told = Clock::now();
    tell(so_far);
  };
}

/// Makes a backup or a restore in place of serving, with a line of progress a second. Returns the
/// exit code.
absl::StatusOr<int> copy_store(const Options& options) {
  if (!options.store.empty()) {
    return absl::FailedPreconditionError(
        "a store in PostgreSQL is backed up by pg_dump and restored by pg_restore, or by the server's archive of its "
        "log; copy the files in --data before that and after it. core/doc/operations.md has the steps");
  }
  const auto progress = each_second([](const BackupReport& so_far) {
    spdlog::info("{} files, {} MB so far", so_far.files, so_far.bytes / 1'000'000);
  });
  const bool is_backup = !options.backup_to.empty();
  const auto done = is_backup ? back_up_store(options.data, options.backup_to, progress)
                              : restore_store(options.restore_from, options.data, progress);
  if (!done.ok()) return done.status();
  tell(done->damages);
  const std::string outcome =
      done->damages.empty() ? "all checked and whole" : absl::StrCat("but ", done->damages.size(), " damaged before");
  spdlog::info("{}: {} files, {} MB, {}",
               is_backup ? "backed up to " + options.backup_to : "restored to " + options.data, done->files,
               done->bytes / 1'000'000, outcome);
  return done->damages.empty() ? 0 : kFoundDamage;
}

/// Looks for damage in place of serving. Returns the exit code.
absl::StatusOr<int> verify(const Options& options) {
  const auto found = verify_store(options.data, options.database(), each_second([](const Verification& so_far) {
                                    spdlog::info("{} records, {} files, {} MB so far", so_far.records, so_far.files,
                                                 so_far.bytes / 1'000'000);
                                  }));
  if (!found.ok()) return found.status();
  tell(found->damages);
  spdlog::info("looked at {} records and {} files, {} MB, in {}: {}", found->records, found->files,
               found->bytes / 1'000'000, options.data,
               found->is_whole() ? "all is what was written" : absl::StrCat(found->damages.size(), " are damaged"));
  return found->is_whole() ? 0 : kFoundDamage;
}

/// Does what the options ask for. Returns the exit code.
absl::StatusOr<int> run(const Options& options) {
  if (options.verify) return verify(options);
  if (!options.backup_to.empty() || !options.restore_from.empty()) return copy_store(options);
  const absl::Status served = serve(options);
  if (!served.ok()) return served;
  return 0;
}

}  // namespace
}  // namespace lipofill::server

int main(int argc, char** argv) {
  using namespace lipofill::server;
  int exit_code = 0;
  const auto options = parse_options(argc, argv, exit_code);
  if (!options) return exit_code;
  set_up_logging(options->log_level, options->log_format);
  ::umask(S_IRWXG | S_IRWXO);  // all that it writes is of patients
  take_signals();
  try {
    const absl::StatusOr<int> done = run(*options);
    if (done.ok()) return *done;
    spdlog::error("{}", std::string(done.status().message()));
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
  }
  return 1;
}
