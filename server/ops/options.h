#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/ops/settings.h"
#include "server/security/security_settings.h"

namespace lipofill::server {

/// The settings of the daemon.
struct Options {
  Options();

  /// Tasks to do in place of serving; at most one is given.
  std::string backup_to;
  std::string restore_from;
  bool verify = false;

  std::vector<std::string> listen = {"127.0.0.1:50061"};
  bool insecure_listen_anywhere = false;
  bool behind_proxy = false;
  int max_connections = 1024;
  int max_connections_per_peer = 128;
  double self_check_s = 5.0;
  std::string port_file;
  std::string metrics_listen;  ///< empty: no metrics over HTTP
  std::string data = "lipofill-data";
  std::string store;      ///< address of a database of PostgreSQL; empty: a file of SQLite in `data`
  std::string name;       ///< of this daemon among those of the database; empty: own_name()
  std::string advertise;  ///< where others call this daemon; empty: own_address()
  int workers = 1;
  int max_simulations = 64;
  int max_simulations_per_tenant = 64;
  int max_running = 16;
  uint64_t simulation_memory_mb = 4096;
  uint64_t max_upload_mb = 256;
  int max_hexahedra = 200'000;
  int max_film_cells = 65'536;
  double keepalive_s = 30.0;
  double keepalive_timeout_s = 20.0;
  int max_viewers = 1000;
  uint64_t viewer_memory_mb;
  double checkpoint_interval_s = 10.0;
  int checkpoints_kept = 3;
  uint64_t checkpoint_space_mb = 8192;
  double park_after_s = 1800.0;
  uint64_t space_reserve_mb = 16;
  double drop_uploads_after_s = 604'800.0;
  double drain_delay_s = 0.0;
  double drain_timeout_s = 30.0;
  std::string log_level = "info";
  std::string log_format = "text";
  bool reflection = true;
  SecuritySettings security;

  /// Says where the database is, see open_database().
  std::string database() const;
  /// True where the database may be shared with other daemons.
  bool is_shared() const { return !store.empty(); }
  /// What this daemon is called among those of its database.
  std::string own_name() const;
  /// Where the others call it, when the first address on TCP has this port.
  std::string own_address(int port) const;
};

/// The version of this program.
const char* program_version();

/// Every setting there is. A new one is a member of Options and an entry here: the file, the
/// environment, the command line, --help and --check follow.
std::vector<Setting> settings_of(Options& options);

/// Checks that values which are well formed one by one also fit together. OK or field violations.
absl::Status check_options(const Options& options);

/// Reads --config's file, the environment and the command line; what comes later wins. Without a
/// value the program ends with `exit_code`: after --help, --version or --check (0), or a mistake
/// (2), all of them named on standard error.
/// Checked by tests/integration/service/configuration_test.cc.
std::optional<Options> parse_options(int argc, char** argv, int& exit_code);

}  // namespace lipofill::server
