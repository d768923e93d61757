#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/application.h"
#include "client/cli/deficit_sheet.h"
#include "client/cli/describe.h"
#include "client/cli/listing.h"
#include "client/cli/options.h"
#include "client/cli/private_daemon.h"
#include "client/cli/process.h"
#include "client/cli/progress_line.h"
#include "client/cli/units.h"
#include "client/cpp/errors.h"
#include "client/cpp/json_message.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/scan_upload.h"
#include "client/cpp/target_call.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

struct Options {
  std::string face;
  std::string landmarks;
  std::string healthy;
  std::string surface;
  std::string surface_landmarks;
  std::string patient;
  std::string out;
  std::string sheet;
  v1::ScanUnit unit = v1::MILLIMETRE;
  v1::ScanUnit surface_unit = v1::MILLIMETRE;
  std::optional<double> rim_mm;
  bool in_place = false;
};

bool is_scan_name(const std::string& text) {
  return absl::StartsWith(text, "patients/");
}

/// The patient that scans are sent to: the one named, that of a scan, or a new one.
absl::StatusOr<std::string> find_patient(const Connection& connection, const Options& options) {
  if (!options.patient.empty()) return full_name("patients", options.patient);
  for (const std::string& name : {options.face, options.surface}) {
    if (is_scan_name(name)) return name.substr(0, name.find('/', std::string("patients/").size()));
  }
  v1::CreatePatientRequest request;
  request.set_display_name("target");
  const auto patient = connection.call<v1::PatientService>(&v1::PatientService::Stub::CreatePatient, request);
  if (!patient.ok()) return patient.status();
  return patient->name();
}

absl::StatusOr<std::string> find_scan(const Connection& connection, const std::string& patient, const std::string& file,
                                      v1::ScanUnit unit) {
  if (is_scan_name(file)) return file;
  const auto scan = upload_scan(connection, patient, file, unit);
  if (!scan.ok()) return scan.status();
  return scan->name();
}

absl::Status add_landmarks(const std::string& file, v1::ScanUnit unit,
                           google::protobuf::Map<std::string, v1::Vector3>* field) {
  if (file.empty()) return absl::OkStatus();
  const auto landmarks = load_landmarks(file, unit);
  if (!landmarks.ok()) return landmarks.status();
  set_landmarks(*landmarks, field);
  return absl::OkStatus();
}

absl::Status check_options(const Options& options) {
  if (options.healthy.empty() == options.surface.empty()) {
    return invalid_fields("no target", {{"--healthy", "or --surface is needed, and not both"}});
  }
  if (!options.healthy.empty() && options.landmarks.empty()) {
    return invalid_fields("no target", {{"--landmarks", "is needed with --healthy"}});
  }
  return absl::OkStatus();
}

absl::StatusOr<v1::MakeTargetRequest> make_request(const Connection& connection, const Options& options) {
  v1::MakeTargetRequest request;
  auto patient = find_patient(connection, options);
  if (!patient.ok()) return patient.status();
  request.set_parent(*patient);
  auto face = find_scan(connection, *patient, options.face, options.unit);
  if (!face.ok()) return face.status();
  v1::TargetSpec& spec = *request.mutable_spec();
  spec.set_scan(*face);
  absl::Status read = add_landmarks(options.landmarks, options.unit, spec.mutable_landmarks_mm());
  if (!read.ok()) return read;
  if (!options.healthy.empty()) {
    spec.mutable_mirrored()->set_healthy_side(options.healthy == "left" ? v1::LEFT : v1::RIGHT);
    return request;
  }
  auto surface = find_scan(connection, *patient, options.surface, options.surface_unit);
  if (!surface.ok()) return surface.status();
  spec.mutable_surface()->set_scan(*surface);
  if (options.in_place) spec.mutable_surface()->set_placement(v1::FaceSurface::IN_PLACE);
  read = add_landmarks(options.surface_landmarks, options.surface_unit, spec.mutable_surface()->mutable_landmarks_mm());
  if (!read.ok()) return read;
  return request;
}

/// Writes a surface as Wavefront OBJ in millimetres.
absl::Status write_obj(const std::vector<Array>& arrays, const std::filesystem::path& path) {
  const Array* points = find_array(arrays, "scan.points");
  const Array* cells = find_array(arrays, "scan.cells");
  if (points == nullptr || cells == nullptr) return absl::DataLossError("the scan came without its surface");
  std::ofstream file(path);
  if (!points->has_points()) return absl::DataLossError("the scan came with points of an unknown type");
  const std::vector<double> coordinates = points->to_doubles();
  for (size_t k = 0; k + 2 < coordinates.size(); k += 3) {
    file << absl::StrFormat("v %.14g %.14g %.14g\n", coordinates[k], coordinates[k + 1], coordinates[k + 2]);
  }
  const auto corners = cells->uint32s();
  for (size_t k = 0; k + 2 < corners.size(); k += 3) {
    file << absl::StrCat("f ", corners[k] + 1, " ", corners[k + 1] + 1, " ", corners[k + 2] + 1, "\n");
  }
  file.close();
  return file ? absl::OkStatus() : absl::InvalidArgumentError(absl::StrCat("cannot write ", path.string()));
}

absl::StatusOr<ExitCode> make_on(Application& application, const Connection& connection, const Options& options) {
  const auto request = make_request(connection, options);
  if (!request.ok()) return request.status();
  ProgressLine progress(application.json);
  const auto target = make_target(connection, *request, [&progress](const std::string& stage, double fraction) {
    progress.show(absl::StrFormat("target %3.0f %%  %s", 100.0 * fraction, stage));
  });
  progress.finish();
  if (!target.ok()) return target.status();
  v1::MeasureDeficitRequest measure;
  measure.set_scan(request->spec().scan());
  *measure.mutable_landmarks_mm() = request->spec().landmarks_mm();
  measure.set_target_scan(target->scan());
  measure.set_figures_only(options.sheet.empty());
  if (options.rim_mm) measure.set_rim_mm(*options.rim_mm);
  auto deficit = measure_deficit(connection, measure);
  if (!deficit.ok()) return deficit.status();
  if (!options.sheet.empty()) {
    const absl::Status drawn = draw_deficit_sheet(connection, request->spec(), *deficit, options.sheet);
    if (!drawn.ok()) return drawn;
    deficit->clear_distance_mm();
  }
  if (!options.out.empty()) {
    const auto surface = download_scan_mesh(connection, target->scan());
    if (!surface.ok()) return surface.status();
    if (auto written = write_obj(*surface, options.out); !written.ok()) return written;
  }
  if (application.json) {
    std::cout << "{\"target\": " << message_json(*target) << ", \"deficit\": " << message_json(*deficit) << "}\n";
  } else {
    std::cout << describe(*target) << describe(*deficit);
  }
  return ExitCode::kOk;
}

/// Files alone need no daemon: a private one computes, and nothing is kept but what --out names.
absl::StatusOr<ExitCode> make(Application& application, const Options& options) {
  if (auto good = check_options(options); !good.ok()) return good;
  if (!options.patient.empty() || is_scan_name(options.face) || is_scan_name(options.surface)) {
    return make_on(application, application.connect(), options);
  }
  const TemporaryFolder data;
  const auto daemon = PrivateDaemon::start(data.path(), application.interrupt().token());
  if (!daemon.ok()) return daemon.status();
  return make_on(application, application.connect_to((*daemon)->server()), options);
}

}  // namespace

void add_target_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      root, application, "target",
      "Make a target for a face, from its healthy side mirrored or from another surface of it, and say what the face "
      "lacks to it, in mL by region. Files alone are computed here; with a patient or scans of the daemon the target "
      "is kept there",
      "  lipofill target face.obj --landmarks face.json --healthy right\n"
      "  lipofill target face.obj --landmarks face.json --healthy right --sheet missing.png\n"
      "  lipofill target before.obj --landmarks before.json --surface after.ply --out target.obj\n"
      "  lipofill target patients/case-7/scans/abc --landmarks face.json --healthy left --json\n",
      [&application, options] { return make(application, *options); });
  command->add_option("face", options->face, "the face as it is: .obj, .ply or .stl, or patients/ID/scans/ID")
      ->required();
  command->add_option("--landmarks", options->landmarks,
                      "its landmarks, FILE.json, FILE.json#OBJECT, .mrk.json, .fcsv, .pp or .csv");
  command->add_option("--healthy", options->healthy, "mirror this side, the subject's own: left or right")
      ->check(CLI::IsMember({"left", "right"}));
  command->add_option("--surface", options->surface,
                      "take this surface of the same face: .obj, .ply or .stl, or patients/ID/scans/ID; it is "
                      "registered without landmarks where it has none");
  command->add_option("--surface-landmarks", options->surface_landmarks, "its landmarks");
  command->add_flag("--in-place", options->in_place, "the surface lies where it belongs: check it, do not move it");
  command->add_option("--patient", options->patient, "patients/ID, or the ID alone: keep scans and target there");
  command->add_option("--rim", options->rim_mm, "mm of skin that are left out where scan or target end; default 5");
  command->add_option("--out", options->out, "write the target to this .obj, in mm");
  command->add_option("--sheet", options->sheet, "draw what is missing on the face, with its figures by region")
      ->type_name("FILE.png");
  command->add_option("--unit", options->unit, "unit of the face's numbers: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
  command->add_option("--surface-unit", options->surface_unit, "unit of the surface's numbers")
      ->transform(choice_of(kUnitNames));
}

}  // namespace lipofill::client
