#include "server/ops/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>

namespace lipofill::server {
namespace {

constexpr char kDescription[] =
    "lipofilld holds patient face models and simulates how injected fat spreads between tissue layers and lifts the "
    "skin.\n"
    "Clients (lipofill, planning GUIs, scripts) drive it over gRPC. A research and planning aid, not a medical device.";

constexpr char kFooter[] =
    "Examples:\n"
    "  lipofilld --data ~/lipofill                       serve on 127.0.0.1:50061\n"
    "  lipofilld --listen 127.0.0.1:0 --port-file port   take a free port and write it to the file, for scripts\n"
    "  lipofilld --listen 0.0.0.0:50061                  serve the network; there is no encryption yet: trusted "
    "networks only\n"
    "\n"
    "SIGTERM and SIGINT stop it gracefully. However it ends, the next start on the same data brings every simulation "
    "back "
    "and goes on with those that ran.";

}  // namespace

std::optional<Options> parse_options(int argc, char** argv, int& exit_code) {
  Options options;
  options.workers = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  CLI::App app(kDescription, "lipofilld");
  app.footer(kFooter);
  app.set_version_flag("--version", std::string("lipofilld " LIPOFILL_VERSION));
  app.add_option("--listen", options.listen, "Address and port to serve; port 0 takes a free one")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--data", options.data, "Directory of the store: patients, scans, models, results; made when missing")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--workers", options.workers, "Threads that run simulations; default: the number of cores")
      ->type_name("N")
      ->check(CLI::Range(1, 256));
  app.add_option("--max-simulations", options.max_simulations, "Simulations that may exist without having ended")
      ->type_name("N")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--max-viewers", options.max_viewers, "Streams of frames that may be open at once")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--keepalive-s", options.keepalive_s, "A client silent for so long is asked whether it is there")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  app.add_option("--keepalive-timeout-s", options.keepalive_timeout_s, "and dropped when it does not answer in so long")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  app.add_option(
         "--checkpoint-interval-s", options.checkpoint_interval_s,
         "Seconds that a running simulation goes on before its state is kept again; 0: not until it is asked for")
      ->type_name("S")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  app.add_option("--checkpoints-kept", options.checkpoints_kept, "States kept of each running simulation, the newest")
      ->type_name("N")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--checkpoint-space-mb", options.checkpoint_space_mb, "What all kept states may take together")
      ->type_name("MB")
      ->check(CLI::Range(uint64_t{1}, uint64_t{100'000'000}))
      ->capture_default_str();
  app.add_option("--log-level", options.log_level, "trace, debug, info, warning, error or off")
      ->type_name("LEVEL")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
  app.add_option("--port-file", options.port_file, "Write the port to this file once the daemon serves")
      ->type_name("PATH");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : 2;
    return std::nullopt;
  }
  return options;
}

}  // namespace lipofill::server
