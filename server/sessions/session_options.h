#pragma once

#include <cstdint>
#include <string>

namespace lipofill::server {

struct SessionOptions {
  std::string id;
  std::string tenant = {};  ///< whose simulations share the workers as one
  uint64_t epoch = 0;
  bool real_time = false;              ///< at most one simulated second a second
  bool preview = false;                ///< a coarse model's settled shape first
  double checkpoint_interval_s = 0.0;  ///< wall time RUNNING between automatic checkpoints; 0: none
};

}  // namespace lipofill::server
