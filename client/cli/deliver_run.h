#pragma once

#include <optional>
#include <string>

#include "client/cli/plan_work.h"
#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::client {

struct DeliverOptions : PlanWorkOptions {
  std::optional<double> max_pass_ml;
  std::optional<double> tunnel_spacing_mm;
  bool compare = false;
};

/// An injection list made on a daemon.
class DeliverRun : public PlanWork {
 public:
  DeliverRun(Application& application, DeliverOptions options);

 private:
  absl::Status work() override;
  absl::Status write_results() const override;
  std::string json() const override;
  std::string text() const override;
  std::string option_of(const std::string& field) const override;

  const DeliverOptions options_;
  v1::Delivery delivery_;
};

}  // namespace lipofill::client
