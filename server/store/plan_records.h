#pragma once

#include <cstdint>
#include <string>

namespace lipofill::server {

/// A plan that is kept. Its message is what its users gave; the rest is the store's.
struct PlanRecord {
  std::string patient;
  std::string id;
  uint64_t revision = 0;  ///< 1, 2, ...; given by the store
  std::string scan;       ///< id of the scan it is for, empty without one
  std::string target;     ///< id of the scan of its target, empty without one
  std::string content_message;
  std::string changes_message;  ///< tells what changed from the revision before
  int64_t create_time_us = 0;
  int64_t update_time_us = 0;
  bool is_damaged = false;  ///< in a list: it is not what was written, and no more than its name is told
};

/// A revision is what a plan was.
struct PlanRevisionRecord {
  uint64_t number = 0;
  std::string content_message;
  std::string changes_message;
  int64_t create_time_us = 0;
};

/// A simulation that was made from a plan.
struct PlanRunRecord {
  std::string simulation;  ///< id
  std::string content_hash;
  int64_t create_time_us = 0;
};

}  // namespace lipofill::server
