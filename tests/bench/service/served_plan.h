#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/connection.h"
#include "client/cpp/plan_file.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "tests/integration/service/daemon_process.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::bench {

/// A plan and what replaces its scan.
struct PlanOptions {
  std::string plan;
  std::string scan;       ///< empty: the plan's own
  std::string landmarks;  ///< the same
};

/// A plan with its landmarks in it.
absl::StatusOr<client::PlanFile> read_plan(const PlanOptions& options);

/// A daemon of its own with the model of a plan, on which simulations of the plan are made.
class ServedPlan {
 public:
  /// Told the name of each piece of work as it ends.
  using EndPhase = std::function<void(const char*)>;

  static absl::StatusOr<std::unique_ptr<ServedPlan>> start(
      const client::PlanFile& plan, int workers, const EndPhase& end_phase = [](const char*) {});

  pid_t daemon() const { return daemon_.pid(); }
  const client::Connection& connection() const { return connection_; }
  /// "skin", the films, and "scan" where there is one.
  std::vector<std::string> meshes() const;
  int scan_triangles() const { return scan_triangles_; }

  /// simulations/ID of the plan, not started, that runs for a simulated time in equal steps and is
  /// never settled.
  absl::Status create(const std::string& id, double simulated_s);
  absl::Status start(const std::string& id);
  absl::Status remove(const std::string& id);
  absl::StatusOr<std::vector<v1::Simulation>> list() const;
  absl::StatusOr<v1::Simulation> get(const std::string& id) const;
  /// Returns once it has ended. FAILED_PRECONDITION when it did not reach its end time.
  absl::StatusOr<v1::Simulation> await_end(const std::string& id) const;

 private:
  ServedPlan(client::PlanFile plan, int workers);
  absl::Status build(const EndPhase& end_phase);

  lipofill::testing::TemporaryDirectory directory_;
  client::PlanFile plan_;
  lipofill::testing::DaemonProcess daemon_;
  client::Connection connection_;
  std::string model_;
  int scan_triangles_ = 0;
};

}  // namespace lipofill::bench
