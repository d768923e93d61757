#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/application.h"
#include "client/cli/convert_command.h"
#include "client/cli/describe.h"
#include "client/cli/listing.h"
#include "client/cli/options.h"
#include "client/cli/progress_line.h"
#include "client/cli/scan_check.h"
#include "client/cli/units.h"
#include "client/cpp/scan_upload.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::PatientService;
using Stub = PatientService::Stub;

struct Options {
  std::string name;
  std::string patient;
  std::string file;
  v1::ScanUnit unit = v1::MILLIMETRE;
};

absl::StatusOr<ExitCode> upload(Application& application, const Options& options) {
  ProgressLine progress(application.json);
  const auto scan = upload_scan(
      application.connect(), full_name("patients", options.patient), options.file, options.unit,
      [&progress](uint64_t sent, uint64_t size) { progress.show(absl::StrFormat("sent %d of %d bytes", sent, size)); });
  progress.finish();
  if (!scan.ok()) return scan.status();
  return application.answer(*scan, describe(*scan));
}

absl::StatusOr<ExitCode> get(Application& application, const Options& options) {
  v1::GetScanRequest request;
  request.set_name(options.name);
  const auto scan = application.connect().call<PatientService>(&Stub::GetScan, request);
  if (!scan.ok()) return scan.status();
  return application.answer(*scan, describe(*scan));
}

absl::StatusOr<ExitCode> list(Application& application, const Options& options) {
  v1::ListScansRequest request;
  request.set_parent(full_name("patients", options.patient));
  const auto all = list_all<PatientService>(application.connect(), &Stub::ListScans, request,
                                            [](v1::ListScansResponse& response) { return response.mutable_scans(); });
  if (!all.ok()) return all.status();
  std::string text;
  for (const v1::Scan& scan : all->scans()) text += list_line(scan);
  text += unreachable_lines(*all);
  return application.answer(*all, text);
}

absl::StatusOr<ExitCode> remove(Application& application, const Options& options) {
  v1::DeleteScanRequest request;
  request.set_name(options.name);
  const auto deleted = application.connect().call<PatientService>(&Stub::DeleteScan, request);
  if (!deleted.ok()) return deleted.status();
  return application.done(absl::StrCat("deleted ", request.name()));
}

}  // namespace

void add_scan_commands(CLI::App& root, Application& application) {
  CLI::App* group = add_group(root, "scan", "Face scans: on the daemon, and out of CT volumes");
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(*group, application, "upload", "Send a surface to the daemon",
                  "  lipofill scan upload case-7 face.ply\n  lipofill scan upload case-7 face.stl --unit m\n",
                  [&application, options] { return upload(application, *options); });
  command->add_option("patient", options->patient, "patients/ID, or the ID alone")->required();
  command->add_option("file", options->file, ".obj, .ply or .stl")->required();
  command->add_option("--unit", options->unit, "unit of the file's numbers: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
  add_command(*group, application, "get", "Show a scan", "  lipofill scan get patients/case-7/scans/abc\n",
              [&application, options] { return get(application, *options); })
      ->add_option("scan", options->name, "patients/ID/scans/ID")
      ->required();
  add_command(*group, application, "list", "List a patient's scans", "  lipofill scan list case-7\n",
              [&application, options] { return list(application, *options); })
      ->add_option("patient", options->patient, "patients/ID, or the ID alone")
      ->required();
  add_command(*group, application, "delete", "Delete a scan that no model was built from",
              "  lipofill scan delete patients/case-7/scans/abc\n",
              [&application, options] { return remove(application, *options); })
      ->add_option("scan", options->name, "patients/ID/scans/ID")
      ->required();
  add_scan_check_command(*group, application);
  add_scan_landmarks_command(*group, application);
  add_volume_commands(*group, application);
  add_convert_command(*group, application);
}

}  // namespace lipofill::client
