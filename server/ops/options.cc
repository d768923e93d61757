#include "server/ops/options.h"

#include <limits.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/ops/listen_address.h"
#include "server/ops/security_options.h"
#include "server/store/data_directory.h"
#include "server/store/database_opening.h"
#include "server/store/postgres_address.h"

namespace lipofill::server {
namespace {

constexpr char kDescription[] =
    "lipofilld holds patient face models and simulates how injected fat spreads between tissue layers and lifts the "
    "skin.\n"
    "Clients (lipofill, planning GUIs, scripts) drive it over gRPC. A research and planning aid, not a medical device.";

constexpr char kFooter[] =
    "Every option can also stand in the file of --config (max-simulations = 8) and in the environment\n"
    "(LIPOFILLD_MAX_SIMULATIONS=8). The command line wins over the environment, the environment over the file.\n"
    "\n"
    "Examples:\n"
    "  lipofilld --data ~/lipofill                       serve on 127.0.0.1:50061\n"
    "  lipofilld --listen 127.0.0.1:0 --port-file port   take a free port and write it to the file, for scripts\n"
    "  lipofilld --listen unix:/run/lipofill.sock        serve this machine's users who may write to the socket\n"
    "  lipofilld --config /etc/lipofill/lipofilld.toml --check\n"
    "                                                    say what is set, and what is wrong with it\n"
    "  lipofilld --data ~/lipofill --backup-to /mnt/backup/today\n"
    "                                                    copy the store while the daemon runs; also checkable by\n"
    "                                                    sha256sum -c SHA256SUMS. 3: something was damaged before,\n"
    "                                                    and is named\n"
    "  lipofilld --data ~/lipofill --verify              look for silent damage of what is kept\n"
    "\n"
    "SIGTERM and SIGINT drain it: it takes no new work, tells viewers, keeps the state of simulations, and ends with "
    "0. "
    "However\nit ends, the next start on the same data brings every simulation back and goes on with those that ran.";

struct CommandLine {
  GivenValues given;
  std::string config;
  bool check = false;
  std::string backup_to;
  std::string restore_from;
  bool verify = false;
  std::vector<std::string> audit_files;  ///< the chains of these are verified
};

std::string configuration_file(const CLI::Option& option) {
  if (option.count() > 0) return option.results().front();
  const char* variable = std::getenv("LIPOFILLD_CONFIG");
  return variable != nullptr ? variable : "";
}

CLI::Option* add_setting(CLI::App& app, const Setting& setting) {
  const std::string flag = "--" + setting.name;
  if (setting.is_switch()) return app.add_flag(flag)->description(setting.help);
  CLI::Option* option = app.add_option(flag)->description(setting.help)->type_name(setting.value_name);
  if (setting.is_list()) option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  const std::string value = setting.text();
  if (value != "\"\"") option->default_str(value);
  return option;
}

/// Reads the command line; when it returns none the program ends with `exit_code`.
std::optional<CommandLine> read_command_line(int argc, char** argv, const std::vector<Setting>& settings,
                                             int& exit_code) {
  CommandLine line;
  CLI::App app(kDescription, "lipofilld");
  app.footer(kFooter);
  app.set_version_flag("--version", std::string("lipofilld " LIPOFILL_VERSION));
  const CLI::Option* config =
      app.add_option("--config")->description("File of settings, TOML; see deploy/lipofilld.toml")->type_name("PATH");
  app.add_flag("--check", line.check, "Read all settings, say what they are or what is wrong with them, and end");
  app.add_option("--backup-to", line.backup_to,
                 "Copy the store in --data to a new directory, whether a daemon serves it or not, and end")
      ->type_name("DIR");
  app.add_option("--restore-from", line.restore_from,
                 "Fill --data, which must have no store yet, from a backup that was checked whole, and end")
      ->type_name("DIR")
      ->excludes("--backup-to");
  app.add_flag("--verify", line.verify,
               "Look at everything that is kept in --data, whether a daemon serves it or not: every record, series, "
               "result, scan and checkpoint, whether it is what was written; name what is damaged, and end with 0 when "
               "nothing is, 3 when something is, 1 when it cannot be looked at")
      ->excludes("--backup-to")
      ->excludes("--restore-from");
  app.add_option("--verify-audit", line.audit_files,
                 "Look through files of an audit log, given in their order, for lines changed, taken out or put in")
      ->type_name("FILE")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  std::vector<CLI::Option*> options;
  for (const Setting& setting : settings) options.push_back(add_setting(app, setting));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : 2;
    return std::nullopt;
  }
  for (size_t i = 0; i < settings.size(); ++i) {
    if (options[i]->count() > 0) line.given[settings[i].name] = {options[i]->results(), "--" + settings[i].name};
  }
  line.config = configuration_file(*config);
  return line;
}

/// `over` wins over what is in `under`.
void lay_over(GivenValues& under, const GivenValues& over) {
  for (const auto& [name, value] : over) under[name] = value;
}

absl::StatusOr<GivenValues> collect(const CommandLine& line, const std::vector<Setting>& settings, Options& options) {
  GivenValues given;
  FieldViolations violations;
  if (!line.config.empty()) {
    auto file = read_settings_file(line.config, settings);
    if (file.ok()) given = *std::move(file);
    violations.absorb("", file.status());
  }
  lay_over(given, read_settings_environment(settings));
  lay_over(given, line.given);
  assign_settings(settings, given, violations);
  violations.absorb("", check_options(options));
  if (!violations.empty()) return violations.to_status();
  return given;
}

void print_settings(const std::vector<Setting>& settings, const GivenValues& given) {
  std::cout << "# The configuration is good.\n";
  for (const Setting& setting : settings) {
    const auto found = given.find(setting.name);
    std::cout << setting.name << " = " << setting.text() << "  # "
              << (found == given.end() ? "default" : found->second.source) << "\n";
  }
}

/// Tells whether strangers on the network get no further than the handshake: each must show a
/// certificate.
bool asks_certificates(const SecuritySettings& security) {
  return security.has_tls() && !security.tls_client_ca_file.empty() && !security.tls_client_certificate_optional;
}

void check_exposure(const Options& options, const std::string& text, FieldViolations& violations) {
  if (options.insecure_listen_anywhere) return;
  const bool is_guarded = options.security.has_tls() && options.security.has_authentication();
  const std::string reached = absl::StrCat("is \"", text, "\", which others on the network reach: ");
  if (!is_guarded) {
    violations.add("listen", absl::StrCat(reached,
                                          "it needs tls-certificate-file, and token-keys-file or "
                                          "client-certificates-file to know who calls; else it must be a loopback "
                                          "address or a UNIX socket, or be told insecure-listen-anywhere"));
  } else if (!asks_certificates(options.security) && !options.behind_proxy) {
    violations.add("listen", absl::StrCat(reached,
                                          "strangers can exhaust the daemon through a connection; put deploy/nginx or "
                                          "deploy/envoy before it and tell it behind-proxy, or demand certificates of "
                                          "all callers by tls-client-ca-file"));
  }
}

void check_listen(const Options& options, FieldViolations& violations) {
  for (const std::string& text : options.listen) {
    const auto address = parse_listen_address(text);
    if (!address.ok()) {
      violations.add("listen", absl::StrCat("is \"", text, "\": ", std::string(address.status().message())));
    } else if (!address->is_local()) {
      check_exposure(options, text, violations);
    }
  }
}

uint64_t machine_memory_mb() {
  return static_cast<uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(::sysconf(_SC_PAGE_SIZE)) / 1'000'000;
}

std::string host_name() {
  char name[HOST_NAME_MAX + 1] = {};
  return ::gethostname(name, sizeof name - 1) == 0 && name[0] != '\0' ? name : "localhost";
}

/// What is given is not repeated: it may hold a password.
void check_store(const Options& options, FieldViolations& violations) {
  if (options.store.empty()) return;
  if (!is_postgres(options.store)) return violations.add("store", "must begin with postgresql://");
  const auto address = parse_postgres_address(options.store);
  if (!address.ok()) violations.add("store", std::string(address.status().message()));
}

}  // namespace

Options::Options()
    : workers(static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 256u))),
      simulation_memory_mb(std::max<uint64_t>(64, machine_memory_mb() / 2)),
      viewer_memory_mb(std::max<uint64_t>(64, machine_memory_mb() / 8)) {}

std::string Options::database() const {
  return store.empty() ? absl::StrCat(data, "/", kDatabaseFile) : store;
}

const char* program_version() {
  return LIPOFILL_VERSION;
}

std::string Options::own_name() const {
  if (!name.empty()) return name;
  const std::string& first = listen.front();
  std::string own = absl::StrCat(host_name().substr(0, 40), "-", first.substr(first.rfind(':') + 1)).substr(0, 64);
  std::replace_if(
      own.begin(), own.end(),
      [](char c) {
        return !is_daemon_name({'x', c});
      },
      '-');
  return own;
}

std::string Options::own_address(int port) const {
  if (!advertise.empty()) return advertise;
  for (const std::string& text : listen) {
    const auto address = parse_listen_address(text);
    if (!address.ok() || address->is_unix()) continue;
    const bool is_any = address->host == "0.0.0.0" || address->host == "::" || address->host.empty();
    const std::string host = is_any ? host_name() : address->host;
    return absl::StrCat(absl::StrContains(host, ':') ? absl::StrCat("[", host, "]") : host, ":", port);
  }
  return listen.front();
}

std::vector<Setting> settings_of(Options& options) {
  std::vector<Setting> settings = {
      {"listen", "ADDRESS", "HOST:PORT (port 0 takes a free one) or unix:PATH to serve; can be given several times",
       &options.listen},
      {"insecure-listen-anywhere", "", "Serve without encryption on addresses that others on the network reach",
       &options.insecure_listen_anywhere},
      {"behind-proxy", "",
       "A proxy that bounds what connections may do (deploy/nginx, deploy/envoy) is all that reaches the addresses of "
       "listen that are not loopback",
       &options.behind_proxy},
      {"max-connections", "N", "Connections that may be open at once", &options.max_connections, 1, 100000},
      {"max-connections-per-peer", "N", "and of one address of the network", &options.max_connections_per_peer, 1,
       100000},
      {"port-file", "PATH", "Write the first TCP port to this file once the daemon serves", &options.port_file},
      {"metrics-listen", "HOST:PORT", "Serve Prometheus metrics over HTTP, path /metrics; default: nowhere",
       &options.metrics_listen},
      {"data", "DIR", "Directory of the store: patients, scans, models, results; made when missing", &options.data},
      {"store", "ADDRESS",
       "Database of records, postgresql://user@host:port/database, PostgreSQL 15; the files stay in --data. Its "
       "password stands in the file of PGPASSFILE. Default: a file of SQLite in --data",
       &options.store},
      {"name", "NAME",
       "What this daemon is called among those that share the database of --store and --data; default: the name of the "
       "machine and the port",
       &options.name},
      {"advertise", "ADDRESS",
       "HOST:PORT or unix:PATH where those daemons, and clients that they send on, call this one; default: the first "
       "address of --listen on TCP",
       &options.advertise},
      {"workers", "N", "Threads that run simulations; default: the number of cores", &options.workers, 1, 256},
      {"max-simulations", "N",
       "Simulations that may be in memory without having ended; those that are parked do not count",
       &options.max_simulations, 1, 100000},
      {"max-simulations-per-tenant", "N", "and of each tenant", &options.max_simulations_per_tenant, 1, 100000},
      {"simulation-memory-mb", "MB",
       "What simulations in memory may take together; default: half of the machine's memory",
       &options.simulation_memory_mb, 64, 1e8},
      {"max-upload-mb", "MB", "Size of a scan that is uploaded", &options.max_upload_mb, 1, 256},
      {"max-hexahedra", "N", "Elements of a model", &options.max_hexahedra, 1, 200000},
      {"max-film-cells", "N", "Cells of the grids of all films of a simulation", &options.max_film_cells, 1, 65536},
      {"max-running", "N", "Simulations that share the workers; more wait in a queue until one of them ends or pauses",
       &options.max_running, 1, 100000},
      {"max-viewers", "N", "Streams of frames that may be open at once", &options.max_viewers, 1, 1e6},
      {"viewer-memory-mb", "MB",
       "What frames that viewers have yet to read may take together; beyond it the slowest viewers are ended; default: "
       "an eighth of the machine's memory",
       &options.viewer_memory_mb, 64, 1e8},
      {"self-check-s", "SECONDS",
       "The daemon connects to its own addresses this often; health says NOT_SERVING while it cannot",
       &options.self_check_s, 0.1, 3600},
      {"keepalive-s", "SECONDS", "A client silent for so long is asked whether it is there", &options.keepalive_s, 0.1,
       86400},
      {"keepalive-timeout-s", "SECONDS", "and dropped when it does not answer in so long", &options.keepalive_timeout_s,
       0.1, 86400},
      {"checkpoint-interval-s", "SECONDS",
       "Seconds that a running simulation goes on before its state is kept again; 0: not until it is asked for",
       &options.checkpoint_interval_s, 0, 86400},
      {"checkpoints-kept", "N", "States kept of each running simulation, the newest", &options.checkpoints_kept, 1,
       100},
      {"checkpoint-space-mb", "MB", "What all kept states may take together", &options.checkpoint_space_mb, 1, 1e8},
      {"park-after-s", "SECONDS",
       "Simulations that rest and that nobody has asked for so long are kept on disk alone until somebody does; 0: "
       "never",
       &options.park_after_s, 0, 1e7},
      {"space-reserve-mb", "MB",
       "Room kept back in --data, so that things can be deleted when the disk is full; 0: none",
       &options.space_reserve_mb, 0, 1e6},
      {"drop-uploads-after-s", "SECONDS",
       "A scan of which bytes have yet to come, and none has come for so long, is removed; 0: never",
       &options.drop_uploads_after_s, 0, 1e9},
      {"drain-delay-s", "SECONDS",
       "After SIGTERM, say NOT_SERVING and go on for this long, so that load balancers notice", &options.drain_delay_s,
       0, 600},
      {"drain-timeout-s", "SECONDS", "After SIGTERM, end within this time whatever is still under way",
       &options.drain_timeout_s, 1, 3600},
      {.name = "log-level",
       .value_name = "LEVEL",
       .help = "trace, debug, info, warning, error or off",
       .target = &options.log_level,
       .choices = {"trace", "debug", "info", "warning", "error", "off"}},
      {.name = "log-format",
       .value_name = "FORMAT",
       .help = "text, or json: one object a line",
       .target = &options.log_format,
       .choices = {"text", "json"}},
      {"reflection", "", "Tell clients what methods there are; false: only those who have the schema know",
       &options.reflection},
  };
  const std::vector<Setting> security = settings_of(options.security);
  settings.insert(settings.end(), security.begin(), security.end());
  return settings;
}

absl::Status check_options(const Options& options) {
  FieldViolations violations;
  check_listen(options, violations);
  if (options.drain_delay_s >= options.drain_timeout_s) {
    violations.add("drain-delay-s", absl::StrCat("is ", options.drain_delay_s, ", must be below drain-timeout-s, ",
                                                 options.drain_timeout_s));
  }
  if (options.data.empty()) violations.add("data", "is empty, must be a directory");
  check_store(options, violations);
  if (!options.name.empty() && !is_daemon_name(options.name)) {
    violations.add("name",
                   absl::StrCat("is \"", options.name,
                                "\", must be 1 to 64 letters, digits, '.', '_', ':' and '-', the first a letter "
                                "or a digit"));
  }
  if (!options.advertise.empty() && !parse_listen_address(options.advertise).ok()) {
    violations.add("advertise", absl::StrCat("is \"", options.advertise, "\", must be HOST:PORT or unix:PATH"));
  }
  if (!options.metrics_listen.empty()) {
    const auto address = parse_listen_address(options.metrics_listen);
    if (!address.ok() || address->is_unix()) {
      violations.add("metrics-listen", absl::StrCat("is \"", options.metrics_listen, "\", must be HOST:PORT"));
    }
  }
  violations.absorb("", check_security(options.security));
  return violations.to_status();
}

std::optional<Options> parse_options(int argc, char** argv, int& exit_code) {
  Options options;
  const std::vector<Setting> settings = settings_of(options);
  const auto line = read_command_line(argc, argv, settings, exit_code);
  if (!line) return std::nullopt;
  if (!line->audit_files.empty()) {
    const auto key = line->given.find("audit-key-file");
    exit_code = print_audit_verification(line->audit_files, key == line->given.end() ? "" : key->second.texts.front());
    return std::nullopt;
  }
  const auto given = collect(*line, settings, options);
  if (!given.ok()) {
    std::cerr << "lipofilld: the configuration cannot be used\n";
    for (const FieldViolation& violation : field_violations_of(given.status())) {
      std::cerr << "  " << violation.field << ": " << violation.description << "\n";
    }
    exit_code = 2;
    return std::nullopt;
  }
  if (line->check) {
    print_settings(settings, *given);
    exit_code = 0;
    return std::nullopt;
  }
  options.backup_to = line->backup_to;
  options.restore_from = line->restore_from;
  options.verify = line->verify;
  return options;
}

}  // namespace lipofill::server
