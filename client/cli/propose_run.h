#pragma once

#include <string>

#include "client/cli/plan_work.h"
#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::client {

struct ProposeOptions : PlanWorkOptions {
  std::string target;  ///< a surface file, or patients/ID/scans/ID
  v1::ScanUnit target_unit = v1::MILLIMETRE;
  v1::ProposalSpec spec;  ///< bounds and the rest, without plan and target
};

/// A plan proposed on a daemon, from scan and target to a plan file that runs.
class ProposeRun : public PlanWork {
 public:
  ProposeRun(Application& application, ProposeOptions options);

 private:
  absl::Status check_input() override;
  absl::Status work() override;
  absl::Status write_results() const override;
  std::string json() const override;
  std::string text() const override;
  std::string option_of(const std::string& field) const override;

  absl::Status send_target();
  absl::Status propose();

  const ProposeOptions options_;
  std::string target_;
  v1::Proposal proposal_;
};

}  // namespace lipofill::client
