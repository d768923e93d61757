#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace lipofill::server {

/// What the command line says.
struct Options {
  std::string listen = "127.0.0.1:50061";
  std::string data = "lipofill-data";
  int workers = 1;
  int max_simulations = 64;
  double keepalive_s = 30.0;
  double keepalive_timeout_s = 20.0;
  int max_viewers = 1000;
  double checkpoint_interval_s = 10.0;
  int checkpoints_kept = 3;
  uint64_t checkpoint_space_mb = 8192;
  std::string log_level = "info";
  std::string port_file;
};

/// Reads the command line. Without a value the program ends with `exit_code`: after --help, --version (0) or a mistake
/// (2).
std::optional<Options> parse_options(int argc, char** argv, int& exit_code);

}  // namespace lipofill::server
