#include "client/cli/report_run.h"

#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "client/cli/report_pictures.h"
#include "client/cli/report_print.h"
#include "client/cpp/errors.h"
#include "client/cpp/json_file.h"
#include "client/cpp/json_message.h"
#include "client/cpp/plan_file.h"
#include "client/cpp/report/document_csv.h"
#include "client/cpp/report/document_html.h"
#include "client/cpp/report/record.h"
#include "client/cpp/result_text.h"
#include "client/cpp/scan_upload.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

bool is_date(const std::string& text) {
  int year = 0;
  unsigned month = 0;
  unsigned day = 0;
  char end = 0;
  if (text.size() != 10 || std::sscanf(text.c_str(), "%4d-%2u-%2u%c", &year, &month, &day, &end) != 3) return false;
  using namespace std::chrono;
  return year_month_day(std::chrono::year(year), std::chrono::month(month), std::chrono::day(day)).ok();
}

}  // namespace

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  return absl::StrFormat("%04d-%02d-%02d", local.tm_year + 1900, local.tm_mon + 1, local.tm_mday);
}

ReportRun::ReportRun(Application& application, ReportOptions options)
    : PlanWork(application, options), options_(std::move(options)) {}

absl::Status ReportRun::check_options() const {
  std::vector<FieldViolation> problems;
  if (!is_date(options_.date)) {
    problems.push_back({"--date", absl::StrCat("is '", options_.date, "', must be a day as YYYY-MM-DD")});
  }
  if (!options_.target.empty() && !options_.healthy.empty()) {
    problems.push_back({"--healthy", "is given beside --target; a report has one target"});
  }
  if (options_.pseudonym != display_name_of(options_.pseudonym)) {
    problems.push_back({"--pseudonym", absl::StrCat("is '", options_.pseudonym,
                                                    "', must have at most 63 characters of a-z, 0-9 and '-'")});
  }
  if (!(options_.reserve_percent >= 0.0 && options_.reserve_percent <= 100.0)) {
    problems.push_back({"--reserve-percent", absl::StrFormat("is %g, must be in [0, 100]", options_.reserve_percent)});
  }
  if (problems.empty()) return absl::OkStatus();
  return invalid_fields("a report that cannot be made", problems);
}

absl::Status ReportRun::check_input() {
  if (auto good = check_options(); !good.ok()) return good;
  language_ = find_language(options_.language).value_or(Language::kEnglish);
  if (!options_.settings.empty()) {
    if (auto loaded = load_message(options_.settings, &spec_); !loaded.ok()) return loaded;
  }
  spec_.MergeFrom(options_.spec);
  return absl::OkStatus();
}

absl::Status ReportRun::work() {
  if (ground_.plan().scan_file && !ground_.model().spec().has_scan_region()) {
    return absl::InvalidArgumentError("the plan has a scan, but its model is a square");
  }
  ReportFetch fetch(ground_, progress_, options_, spec_);
  absl::Status status = fetch.fetch();
  if (status.ok()) status = make_record(fetch);
  if (!options_.keep || !status.ok()) fetch.clean_up();
  return status;
}

/// The name that the patient goes by, never more than that.
absl::StatusOr<std::string> ReportRun::find_pseudonym() const {
  if (!options_.pseudonym.empty() || options_.patient.empty()) return options_.pseudonym;
  v1::GetPatientRequest request;
  request.set_name(ground_.patient());
  const auto patient = ground_.connection().call<v1::PatientService>(&v1::PatientService::Stub::GetPatient, request);
  if (!patient.ok()) return patient.status();
  if (!patient->display_name().empty()) return patient->display_name();
  return std::string(absl::StripPrefix(patient->name(), "patients/"));
}

absl::Status ReportRun::make_record(const ReportFetch& fetch) {
  const auto plan_hash = sha256_of_file(ground_.plan().path);
  if (!plan_hash.ok()) return plan_hash.status();
  const auto pseudonym = find_pseudonym();
  if (!pseudonym.ok()) return pseudonym.status();
  record_ = report_record(fetch.answers(), {options_.date, *pseudonym, LIPOFILL_VERSION, options_.command, *plan_hash,
                                            0.01 * options_.reserve_percent});
  progress_.show("drawing the pictures");
  const ReportPictures pictures = draw_report_pictures(fetch);
  pictures_problem_ = pictures.problem;
  const ReportDocument document = make_report_document(RecordReader(record_, language_), pictures, options_.paper);
  html_ = document_html(document);
  csv_ = document_csv(document);
  return absl::OkStatus();
}

absl::Status ReportRun::write_results() const {
  const std::filesystem::path folder = options_.out;
  absl::Status written = write_text_file(folder / "report.json", record_.dump(2) + "\n");
  if (written.ok()) written = write_text_file(folder / "report.csv", csv_);
  if (written.ok()) written = write_text_file(folder / "report.html", html_);
  if (!written.ok() || options_.no_pdf) return written;
  const absl::Status printed = print_html(folder / "report.html", folder / "report.pdf");
  if (!printed.ok()) pdf_problem_ = std::string(printed.message());
  return absl::OkStatus();
}

std::string ReportRun::json() const {
  return record_.dump(2);
}

std::string ReportRun::text() const {
  const auto& total = record_.at("volumes").at("total");
  std::string text =
      absl::StrFormat("to inject %.2f mL, to prepare %.2f mL; after %g months %.2f mL are left (median)\n",
                      total.at("inject_ml").get<double>(), total.at("prepare_ml").get<double>(),
                      record_.at("volumes").at("month").get<double>(), total.at("remaining_ml").get<double>());
  if (!pictures_problem_.empty()) absl::StrAppend(&text, "no pictures: ", pictures_problem_, "\n");
  if (!pdf_problem_.empty()) absl::StrAppend(&text, "no report.pdf: ", pdf_problem_, "\n");
  const bool has_pdf = !options_.no_pdf && pdf_problem_.empty();
  return absl::StrCat(text, "report.html, ", has_pdf ? "report.pdf, " : "", "report.csv and report.json in ",
                      options_.out, "\n", kNotAMedicalDevice, "\n");
}

std::string ReportRun::option_of(const std::string& field) const {
  for (const char* prefix : {"spec.plan.", "plan."}) {
    if (absl::StartsWith(field, prefix)) return absl::StrCat("simulation.", absl::StripPrefix(field, prefix));
  }
  return field == "spec.members" ? "--members" : field;
}

}  // namespace lipofill::client
