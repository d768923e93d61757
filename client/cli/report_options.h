#pragma once

#include <string>

#include "client/cli/plan_work.h"
#include "client/cpp/report/document.h"
#include "lipofill/v1/forecast_service.pb.h"

namespace lipofill::client {

struct ReportOptions : PlanWorkOptions {
  std::string target;            ///< a surface, or the name of a scan; empty: none
  std::string target_landmarks;  ///< of that surface
  v1::ScanUnit target_unit = v1::MILLIMETRE;
  bool in_place = false;
  std::string healthy;  ///< the side to mirror, "left" or "right"; empty: none
  bool no_forecast = false;
  std::string settings;   ///< a file with a ForecastSpec; what options say comes on top
  v1::ForecastSpec spec;  ///< what options say, without the plan
  std::string pseudonym;  ///< of the patient
  std::string date;       ///< empty: today's
  std::string language = "en";
  Paper paper = Paper::kA4;
  double reserve_percent = 10.0;
  bool no_pdf = false;
  std::string command;  ///< that makes the report again
};

}  // namespace lipofill::client
