#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/describe.h"
#include "client/cli/options.h"
#include "client/cli/picture.h"
#include "client/cli/private_daemon.h"
#include "client/cli/process.h"
#include "client/cli/progress_line.h"
#include "client/cli/scan_check.h"
#include "client/cli/units.h"
#include "client/cli/volume_check.h"
#include "client/cpp/gltf/gltf_surface.h"
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
    "a daemon; --picture draws the surface from three sides with its borders in red. Of a volume (MetaImage, NRRD, "
    "NIfTI, or a folder, zip or file of DICOM) it says size, spacing, axes, values, the series there are, and the "
    "labels with the tissues they are taken for; --picture draws the three slices through its middle.";

constexpr char kExamples[] =
    "  lipofill scan check face.obj\n"
    "  lipofill scan check face.stl --unit m --picture face.png\n"
    "  lipofill scan check face.glb\n"
    "  lipofill scan check ct/ --picture slices.png\n"
    "  lipofill scan check segmentation.nrrd\n"
    "  lipofill scan check face.ply --json | jq .report.mending_remarks\n";

struct Options {
  std::string file;
  std::string picture;
  std::string series;
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

/// A glTF becomes the PLY that a daemon takes; what was passed over is said beside its report.
absl::Status take_gltf(const std::filesystem::path& folder, Options* options, std::vector<std::string>* remarks) {
  const auto surface = read_gltf_surface(options->file);
  if (!surface.ok()) return surface.status();
  const double mm = gltf_unit_mm(*surface, millimetres_of(options->unit));
  *remarks = surface->remarks;
  remarks->push_back(absl::StrFormat("its numbers are taken for units of %g mm", mm));
  if (!surface->colours.empty()) remarks->push_back("its vertices have colours, which scan convert keeps");
  const std::filesystem::path ply = folder / "surface.ply";
  if (auto written = write_text_file(ply, ply_bytes(*surface, mm)); !written.ok()) return written;
  options->file = ply.string();
  options->unit = v1::MILLIMETRE;
  return absl::OkStatus();
}

absl::StatusOr<ExitCode> check_a_volume(const Application& application, const Options& options) {
  const auto found = check_volume(options.file, options.series, options.picture);
  if (!found.ok()) return found.status();
  if (application.json) {
    nlohmann::ordered_json document = {{"file", options.file}, {"volume", *found}};
    if (!options.picture.empty()) document["picture"] = options.picture;
    std::cout << document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
    return ExitCode::kOk;
  }
  std::cout << options.file << "\n" << describe_volume(*found);
  if (!options.picture.empty()) std::cout << "  picture   " << options.picture << "\n";
  return ExitCode::kOk;
}

absl::StatusOr<ExitCode> check(Application& application, Options options) {
  if (holds_a_volume(options.file)) return check_a_volume(application, options);
  const std::string named = options.file;
  const TemporaryFolder converted;
  std::vector<std::string> remarks;
  if (is_gltf_name(options.file)) {
    if (auto taken = take_gltf(converted.path(), &options, &remarks); !taken.ok()) return taken;
  }
  const TemporaryFolder data;
  const auto daemon = PrivateDaemon::start(data.path(), application.interrupt().token());
  if (!daemon.ok()) return daemon.status();
  const Connection connection = application.connect_to((*daemon)->server());
  auto scan = send(connection, options, application.json);
  if (!scan.ok()) return scan.status();
  for (const std::string& remark : remarks) scan->mutable_report()->add_read_remarks(remark);
  if (!options.picture.empty()) {
    if (auto drawn = draw(connection, *scan, options); !drawn.ok()) return drawn;
  }
  if (application.json) {
    nlohmann::ordered_json document = {{"file", named},
                                       {"report", nlohmann::ordered_json::parse(message_json(scan->report()))}};
    if (!options.picture.empty()) document["picture"] = options.picture;
    std::cout << document.dump(2) << "\n";
    return ExitCode::kOk;
  }
  std::cout << named << "\n" << surface_text(scan->report());
  if (!options.picture.empty()) std::cout << "  picture   " << options.picture << "\n";
  return ExitCode::kOk;
}

}  // namespace

void add_scan_check_command(CLI::App& scan, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_local_command(scan, application, "check", kDescription, kExamples,
                                        [&application, options] { return check(application, *options); });
  command
      ->add_option("file", options->file,
                   ".obj, .ply, .stl, .glb, .gltf, a volume (.mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz, .hdr) or DICOM")
      ->required();
  command->add_option("--series", options->series, "of DICOM: SeriesNumber or SeriesInstanceUID");
  command->add_option("--unit", options->unit, "unit of the file's numbers: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
  command->add_option("--picture", options->picture, "draw the surface into this file")->type_name("FILE.png");
}

}  // namespace lipofill::client
