#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "client/cli/report_fetch.h"
#include "client/cli/report_options.h"
#include "client/cpp/report/language.h"

namespace lipofill::client {

/// A report made of a daemon's answers, from a plan file to a page that is printed.
class ReportRun : public PlanWork {
 public:
  ReportRun(Application& application, ReportOptions options);

 private:
  absl::Status check_input() override;
  absl::Status work() override;
  absl::Status write_results() const override;
  std::string json() const override;
  std::string text() const override;
  std::string option_of(const std::string& field) const override;

  absl::Status check_options() const;
  absl::StatusOr<std::string> find_pseudonym() const;
  absl::Status make_record(const ReportFetch& fetch);

  const ReportOptions options_;
  Language language_ = Language::kEnglish;
  v1::ForecastSpec spec_;
  nlohmann::ordered_json record_;
  std::string html_;
  std::string csv_;
  std::string pictures_problem_;
  mutable std::string pdf_problem_;
};

/// Today's date, YYYY-MM-DD, by the clock of this machine.
std::string today();

}  // namespace lipofill::client
