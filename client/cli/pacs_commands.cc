#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/records_command.h"
#include "client/cpp/records/pacs.h"
#include "client/cpp/records/stow.h"

namespace lipofill::client {
namespace {

struct Options {
  std::string pacs;
  std::string own_title = "LIPOFILL";
  PacsQuery query;
  std::string study_uid;
  std::string series_uid;
  std::string out;
  std::vector<std::string> files;
  WebArchive web;
};

std::string from_environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// Sends over the web where the address is a URL, else by DIMSE; returns what to call the archive.
absl::StatusOr<std::string> send_files(const Options& options) {
  const std::vector<std::filesystem::path> files(options.files.begin(), options.files.end());
  if (is_web_address(options.pacs)) {
    WebArchive web = options.web;
    web.url = options.pacs;
    web.password = from_environment("LIPOFILL_PACS_PASSWORD");
    web.token = from_environment("LIPOFILL_PACS_TOKEN");
    if (auto status = send_to_web_archive(web, files); !status.ok()) return status;
    return web.url;
  }
  const auto pacs = parse_pacs_address(options.pacs, options.own_title);
  if (!pacs.ok()) return pacs.status();
  if (auto status = send_to_pacs(*pacs, files); !status.ok()) return status;
  return pacs->title;
}

absl::StatusOr<ExitCode> find(const Application& application, const Options& options) {
  const auto pacs = parse_pacs_address(options.pacs, options.own_title);
  if (!pacs.ok()) return pacs.status();
  const auto found = find_in_pacs(*pacs, options.query);
  if (!found.ok()) return found.status();
  if (application.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const PacsSeries& each : *found) {
      all.push_back({{"study_uid", each.study_uid},
                     {"study_date", each.study_date},
                     {"series_uid", each.series_uid},
                     {"series_number", each.series_number},
                     {"modality", each.modality},
                     {"description", each.description},
                     {"images", each.images}});
    }
    std::cout << nlohmann::ordered_json{{"series", all}}.dump(2) << "\n";
    return ExitCode::kOk;
  }
  for (const PacsSeries& each : *found) {
    std::cout << absl::StrFormat("%s  %s %s  %s, %s images\n  study  %s\n  series %s\n", each.study_date,
                                 each.series_number, each.modality, each.description,
                                 each.images.empty() ? "?" : each.images, each.study_uid, each.series_uid);
  }
  std::cout << absl::StrFormat("series: %d\n", found->size());
  return ExitCode::kOk;
}

absl::StatusOr<ExitCode> fetch(const Application& application, const Options& options) {
  const auto pacs = parse_pacs_address(options.pacs, options.own_title);
  if (!pacs.ok()) return pacs.status();
  const auto count = fetch_from_pacs(*pacs, options.study_uid, options.series_uid, options.out);
  if (!count.ok()) return count.status();
  if (application.json) {
    std::cout << nlohmann::ordered_json{{"files", *count}, {"folder", options.out}}.dump(2) << "\n";
    return ExitCode::kOk;
  }
  return application.done(absl::StrCat("fetched ", *count, " files into ", options.out));
}

absl::StatusOr<ExitCode> send(const Application& application, const Options& options) {
  const auto taker = send_files(options);
  if (!taker.ok()) return taker.status();
  if (application.json) {
    std::cout << nlohmann::ordered_json{{"sent", options.files.size()}}.dump(2) << "\n";
    return ExitCode::kOk;
  }
  return application.done(absl::StrCat(*taker, " has taken ", options.files.size(), " files"));
}

CLI::App* add_pacs_command(CLI::App& group, Application& application, const std::shared_ptr<Options>& options,
                           const std::string& name, const std::string& description, const std::string& examples,
                           absl::StatusOr<ExitCode> (*action)(const Application&, const Options&)) {
  CLI::App* command = add_local_command(group, application, name, description, examples,
                                        [&application, options, action] { return action(application, *options); });
  command->add_option("--pacs", options->pacs, "the PACS, by its title, host and port")
      ->type_name("TITLE@HOST:PORT")
      ->envname("LIPOFILL_PACS")
      ->required();
  command->add_option("--as", options->own_title, "title that this program calls itself by; default LIPOFILL")
      ->type_name("TITLE");
  return command;
}

}  // namespace

void add_pacs_commands(CLI::App& group, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_pacs_command(
      group, application, options, "find",
      "The series that a PACS has (C-FIND). Names of patients are neither asked for nor shown. DICOM is not encrypted "
      "here: use it inside the network of the clinic",
      "  lipofill records find --pacs ORTHANC@localhost:4242 --patient-id 4711 --modality CT\n", find);
  command->add_option("--patient-id", options->query.patient_id, "number of the patient; * stands for anything");
  command->add_option("--accession", options->query.accession_number, "accession number");
  command->add_option("--date", options->query.study_date, "day of the study, or a range of days")
      ->type_name("YYYYMMDD[-YYYYMMDD]");
  command->add_option("--study", options->query.study_uid, "UID of a study");
  command->add_option("--modality", options->query.modality, "CT, MR, SEG, SR, DOC, M3D, ...");

  command = add_pacs_command(
      group, application, options, "fetch",
      "Fetches a study, or one series of it, from a PACS (C-GET) into a new folder, which only you can read: its files "
      "hold the patient's name. lipofill scan series and lipofill scan extract read the folder",
      "  lipofill records fetch --pacs ORTHANC@localhost:4242 --study 1.2.3 --series 1.2.3.4 --out ct\n"
      "  lipofill scan extract ct --out skin.ply\n",
      fetch);
  command->add_option("--study", options->study_uid, "UID of the study")->required();
  command->add_option("--series", options->series_uid, "UID of the series; default: all of the study");
  command->add_option("--out", options->out, "folder, empty or new")->required();

  command =
      add_pacs_command(group, application, options, "send",
                       "Sends files of DICOM to a PACS: by C-STORE, or by STOW-RS where --pacs is the address of a "
                       "DICOMweb service, over TLS where it begins with https://. A password is taken from "
                       "LIPOFILL_PACS_PASSWORD, a token from LIPOFILL_PACS_TOKEN. What the PACS has already it "
                       "keeps",
                       "  lipofill records send --pacs ORTHANC@localhost:4242 records/*.dcm\n"
                       "  lipofill records send --pacs https://pacs.example/dicom-web records/*.dcm\n",
                       send);
  command->add_option("--ca", options->web.ca_file, "certificates that vouch for a web service; default: the system's")
      ->type_name("FILE.pem")
      ->check(CLI::ExistingFile.description(""));
  command->add_option("--user", options->web.user, "name to log in to a web service by");
  command->add_option("files", options->files, "files of lipofill records make, or any of DICOM")->required();
}

}  // namespace lipofill::client
