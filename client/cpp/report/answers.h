#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lipofill/v1/forecast_service.pb.h"
#include "lipofill/v1/patient_service.pb.h"
#include "lipofill/v1/planning_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

/// A settled shape, and how near it comes to the target.
struct ReportedShape {
  v1::Simulation simulation;
  std::optional<v1::Evaluation> evaluation;
};

/// The answers hold what a daemon said for a report, and what it was asked.
struct ReportAnswers {
  v1::Plan plan;
  std::optional<v1::Scan> scan;
  v1::Model model;
  std::vector<v1::UncertainInput> inputs;
  v1::RetentionEstimate retention;
  ReportedShape planned;
  ReportedShape remaining;  ///< with what is left after the last month
  std::optional<v1::Forecast> forecast;
  std::string no_forecast;  ///< why there is none, where it was asked for
  std::optional<v1::Scan> target;
  std::optional<v1::Deficit> deficit;
  std::optional<v1::Delivery> delivery;
  std::string no_delivery;  ///< why there is none
};

/// The facts are what a report says beyond that.
struct ReportFacts {
  std::string date;       ///< YYYY-MM-DD
  std::string pseudonym;  ///< of the patient; may be empty
  std::string version;    ///< of the program
  std::string command;    ///< that makes it again
  std::string plan_sha256;
  double reserve_share = 0.1;  ///< fat to prepare beyond what is injected
};

/// The share of the fat that is left after the last month.
const v1::RetentionAtMonth& last_month_of(const v1::RetentionEstimate& retention);

}  // namespace lipofill::client
