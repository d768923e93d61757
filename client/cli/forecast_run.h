#pragma once

#include <string>

#include "client/cli/application.h"
#include "client/cli/progress_line.h"
#include "client/cli/run_ground.h"
#include "lipofill/v1/forecast_service.pb.h"

namespace lipofill::client {

struct ForecastOptions : GroundOptions {
  std::string settings;  ///< a file with a ForecastSpec, what options say comes on top
  bool keep = false;
  bool quiet = false;
  v1::ForecastSpec spec;  ///< what options say, without the plan
};

/// A forecast made on a daemon, from a plan file to a file of figures: each member function is one
/// step, in their order in `carry_out`.
class ForecastRun {
 public:
  ForecastRun(Application& application, ForecastOptions options);

  absl::StatusOr<ExitCode> carry_out();

 private:
  absl::Status read_input();
  absl::Status prepare_ground();
  absl::Status make();
  absl::Status write_results() const;
  void print() const;

  Application& application_;
  const ForecastOptions options_;
  ProgressLine progress_;
  RunGround ground_;
  v1::ForecastSpec spec_;
  v1::Forecast forecast_;
};

/// A forecast, and a retention, for people.
std::string describe(const v1::Forecast& forecast);
std::string describe(const v1::RetentionEstimate& estimate);

}  // namespace lipofill::client
