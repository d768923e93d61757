#pragma once

#include <string>

#include "client/cli/plan_work.h"
#include "lipofill/v1/forecast_service.pb.h"

namespace lipofill::client {

struct ForecastOptions : PlanWorkOptions {
  std::string settings;   ///< a file with a ForecastSpec, what options say comes on top
  v1::ForecastSpec spec;  ///< what options say, without the plan
};

/// A forecast made on a daemon, from a plan file to a file of figures.
class ForecastRun : public PlanWork {
 public:
  ForecastRun(Application& application, ForecastOptions options);

 private:
  absl::Status check_input() override;
  absl::Status work() override;
  absl::Status write_results() const override;
  std::string json() const override;
  std::string text() const override;
  std::string option_of(const std::string& field) const override;

  const ForecastOptions options_;
  v1::ForecastSpec spec_;
  v1::Forecast forecast_;
};

/// A forecast, and a retention, for people.
std::string describe(const v1::Forecast& forecast);
std::string describe(const v1::RetentionEstimate& estimate);

}  // namespace lipofill::client
