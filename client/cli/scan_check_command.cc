#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "client/cli/describe.h"
#include "client/cli/options.h"
#include "client/cli/picture.h"
#include "client/cli/private_daemon.h"
#include "client/cli/process.h"
#include "client/cli/progress_line.h"
#include "client/cli/scan_check.h"
#include "client/cli/units.h"
#include "client/cpp/io/mesh_files.h"
#include "client/cpp/json_file.h"
#include "client/cpp/json_message.h"
#include "client/cpp/scan_upload.h"
#include "client/cpp/target_call.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "Check a scan without keeping it: what the file has (parts, borders, size), what of it was passed over or left "
    "out, and what a model of it will mend. A file that cannot be read is refused with the place in it. Works without "
    "a daemon; --picture draws the surface from three sides with its borders in red.";

constexpr char kExamples[] =
    "  lipofill scan check face.obj\n"
    "  lipofill scan check face.stl --unit m --picture face.png\n"
    "  lipofill scan check face.ply --json | jq .report.mending_remarks\n";

struct Options {
  std::string file;
  std::string picture;
  v1::ScanUnit unit = v1::MILLIMETRE;
};

absl::StatusOr<v1::Scan> send(const Connection& connection, const Options& options, bool json) {
  const auto patient =
      connection.call<v1::PatientService>(&v1::PatientService::Stub::CreatePatient, v1::CreatePatientRequest());
  if (!patient.ok()) return patient.status();
  ProgressLine progress(json);
  auto scan = upload_scan(connection, patient->name(), options.file, options.unit, [&](uint64_t sent, uint64_t size) {
    progress.show(absl::StrCat("reading ", sent, " of ", size, " bytes"));
  });
  progress.finish();
  return scan;
}

absl::Status draw(const Connection& connection, const v1::Scan& scan, const Options& options) {
  const auto arrays = download_scan_mesh(connection, scan.name());
  if (!arrays.ok()) return arrays.status();
  const auto views = mesh_views(*arrays, {});
  if (!views.ok()) return views.status();
  if (views->size() != 1) return absl::DataLossError("the daemon sent another number of meshes than one");
  const TemporaryFolder folder;
  if (auto written = write_mesh(folder.path() / kScanToDraw, views->front()); !written.ok()) return written;
  const std::string remarks = surface_text(scan.report());
  if (auto written = write_text_file(folder.path() / kTextToDraw, remarks); !written.ok()) return written;
  return draw_picture(folder.path(), Picture::kScan, std::filesystem::absolute(options.picture));
}

absl::StatusOr<ExitCode> check(Application& application, const Options& options) {
  const TemporaryFolder data;
  const auto daemon = PrivateDaemon::start(data.path(), application.interrupt().token());
  if (!daemon.ok()) return daemon.status();
  const Connection connection = application.connect_to((*daemon)->server());
  const auto scan = send(connection, options, application.json);
  if (!scan.ok()) return scan.status();
  if (!options.picture.empty()) {
    if (auto drawn = draw(connection, *scan, options); !drawn.ok()) return drawn;
  }
  if (application.json) {
    nlohmann::ordered_json document = {{"file", options.file},
                                       {"report", nlohmann::ordered_json::parse(message_json(scan->report()))}};
    if (!options.picture.empty()) document["picture"] = options.picture;
    std::cout << document.dump(2) << "\n";
    return ExitCode::kOk;
  }
  std::cout << options.file << "\n" << surface_text(scan->report());
  if (!options.picture.empty()) std::cout << "  picture   " << options.picture << "\n";
  return ExitCode::kOk;
}

}  // namespace

void add_scan_check_command(CLI::App& scan, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_local_command(scan, application, "check", kDescription, kExamples,
                                        [&application, options] { return check(application, *options); });
  command->add_option("file", options->file, ".obj, .ply or .stl")->required();
  command->add_option("--unit", options->unit, "unit of the file's numbers: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
  command->add_option("--picture", options->picture, "draw the surface into this file")->type_name("FILE.png");
}

}  // namespace lipofill::client
