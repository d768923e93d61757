#pragma once

#include <cstdint>
#include <string>

#include "server/store/scope.h"

namespace lipofill::server {

/// A long-running operation that outlives the daemon: what was asked, and what came of it.
struct OperationRecord {
  std::string id;
  std::string patient;  ///< whose it is, with whom it goes
  std::string tenant = kLocalTenant;
  std::string method = {};  ///< as RequestKey has it, with the two that follow
  std::string request_id = {};
  std::string fingerprint = {};
  std::string request_message = {};
  bool done = false;
  std::string response_message = {};  ///< once done
  int64_t create_time_us = 0;
};

}  // namespace lipofill::server
