#include "client/cli/run_ground.h"

#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "client/cli/describe.h"
#include "client/cli/listing.h"
#include "client/cli/options.h"
#include "client/cli/units.h"
#include "client/cpp/errors.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/model_build.h"
#include "client/cpp/result_text.h"
#include "client/cpp/scan_upload.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {

using v1::PatientService;

void add_ground_options(CLI::App& command, GroundOptions& options, const std::string& help_of_spawn) {
  command.add_flag("--spawn", options.spawn, help_of_spawn)->excludes(command.get_option("--server"));
  command.add_option("--patient", options.patient, "a patient the daemon has; default: a new one");
  command.add_option("--scan", options.scan, "surface in place of the plan's");
  command.add_option("--bone", options.bone, "surface of the bone in place of the plan's, in the frame of the scan");
  command.add_option("--landmarks", options.landmarks,
                     "landmarks in place of the plan's; FILE.json, FILE.json#object, .mrk.json, .fcsv, .pp or .csv");
  command.add_option("--unit", options.unit, "unit of the scan, and of what --bone names: mm, cm or m")
      ->transform(choice_of(kUnitNames));
}

absl::Status RunGround::make_folder() const {
  std::error_code error;
  std::filesystem::create_directories(options_.out, error);
  if (!error) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("cannot make the folder ", options_.out, ": ", error.message()));
}

absl::Status RunGround::read_plan() {
  auto plan = load_plan(options_.plan);
  if (!plan.ok()) return plan.status();
  plan_ = *std::move(plan);
  if (plan_.plan.parts_size() > 0 && !options_.several_parts) {
    return invalid_fields("a plan of several parts",
                          {{"parts", "are taken by lipofill run only; make a plan of one part for this"}});
  }
  if (!options_.scan.empty()) plan_.scan_file = options_.scan;
  if (!options_.bone.empty()) plan_.bone_file = options_.bone;
  if (!options_.landmarks.empty()) {
    plan_.landmarks_file = options_.landmarks;
    plan_.plan.mutable_model()->mutable_scan_region()->clear_landmarks_mm();
    plan_.plan.mutable_model()->mutable_scan_region()->clear_axes();
  }
  if (options_.unit) {
    plan_.plan.mutable_scan()->set_unit(*options_.unit);
    if (!options_.bone.empty()) plan_.plan.mutable_bone()->set_unit(*options_.unit);
  }
  if (plan_.plan.name().empty()) plan_.plan.set_name(plan_.path.stem().string());
  if (auto status = load_plan_landmarks(&plan_); !status.ok()) return status;
  if (auto status = check_bone_file(plan_); !status.ok()) return status;
  take_region_from_zones(&plan_.plan);
  model_spec_ = plan_.plan.model();
  return absl::OkStatus();
}

absl::Status RunGround::reach_daemon() {
  const std::stop_token stop = application_.interrupt().token();
  if (!options_.spawn) {
    connection_ = application_.connect();
    return absl::OkStatus();
  }
  auto daemon = PrivateDaemon::start(std::filesystem::path(options_.out) / kPrivateData, stop);
  if (!daemon.ok()) return daemon.status();
  daemon_ = *std::move(daemon);
  connection_ = application_.connect_to(daemon_->server());
  return absl::OkStatus();
}

absl::Status RunGround::prepare_patient() {
  if (!options_.patient.empty()) {
    patient_ = full_name("patients", options_.patient);
    return absl::OkStatus();
  }
  const auto patient =
      connection_->call<PatientService>(&PatientService::Stub::CreatePatient, v1::CreatePatientRequest());
  if (!patient.ok()) return patient.status();
  patient_ = patient->name();
  made_patient_ = true;
  return absl::OkStatus();
}

absl::StatusOr<v1::Scan> RunGround::send_surface(const std::filesystem::path& file, v1::ScanUnit unit,
                                                 const char* what) {
  auto scan = upload_scan(*connection_, patient_, file, unit, [this, what](uint64_t sent, uint64_t size) {
    progress_.show(absl::StrFormat("sending the %s: %d of %d bytes", what, sent, size));
  });
  if (!scan.ok()) return scan.status();
  progress_.finish(
      absl::StrFormat("%s: %d vertices, %d triangles", what, scan->report().vertices(), scan->report().triangles()));
  return scan;
}

absl::Status RunGround::send_scan() {
  if (plan_.scan_file) {
    const auto scan = send_surface(*plan_.scan_file, plan_.plan.scan().unit(), "scan");
    if (!scan.ok()) return scan.status();
    model_spec_.mutable_scan_region()->set_scan(scan->name());
  }
  if (plan_.bone_file) {
    const auto bone = send_surface(*plan_.bone_file, plan_.plan.bone().unit(), "bone");
    if (!bone.ok()) return bone.status();
    model_spec_.mutable_scan_region()->set_bone_scan(bone->name());
  }
  return absl::OkStatus();
}

absl::Status RunGround::prepare() {
  for (const auto step :
       {&RunGround::reach_daemon, &RunGround::prepare_patient, &RunGround::send_scan, &RunGround::build}) {
    if (const absl::Status status = (this->*step)(); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status RunGround::build() {
  auto model = build_for(model_spec_, "");
  if (!model.ok()) return model.status();
  model_ = *std::move(model);
  return absl::OkStatus();
}

absl::StatusOr<v1::Model> RunGround::build_for(v1::ModelSpec spec, const std::string& part) {
  const v1::ScanRegion& sent = model_spec_.scan_region();
  if (!sent.scan().empty()) spec.mutable_scan_region()->set_scan(sent.scan());
  if (!sent.bone_scan().empty()) spec.mutable_scan_region()->set_bone_scan(sent.bone_scan());
  v1::BuildModelRequest request;
  request.set_parent(patient_);
  *request.mutable_spec() = std::move(spec);
  const std::string what = part.empty() ? "model" : absl::StrCat("model of ", part);
  auto model = build_model(*connection_, request, [this, &what](const std::string& stage, double fraction) {
    progress_.show(absl::StrFormat("building the %s: %.0f %%  %s", what, 100.0 * fraction, stage));
  });
  if (!model.ok()) return model;
  const v1::ModelReport& report = model->report();
  progress_.finish(absl::StrFormat("%s: %d hexahedra over %.1f cm2, worst scaled Jacobian %.2f", what,
                                   report.hexahedra(), report.area_cm2(), report.min_scaled_jacobian()));
  for (const std::string& remark : report.scan_remarks()) progress_.note(absl::StrCat("  ", remark));
  for (const std::string& remark : plan_.landmark_remarks) progress_.note(absl::StrCat("  ", remark));
  for (const auto line : absl::StrSplit(layers_text(report), '\n', absl::SkipEmpty()))
    progress_.note(std::string(line));
  return model;
}

void RunGround::delete_patient() {
  if (!connection_ || !made_patient_) return;
  v1::DeletePatientRequest request;
  request.set_name(patient_);
  request.set_force(true);
  (void)connection_->without_stop().call<PatientService>(&PatientService::Stub::DeletePatient, request);
}

void RunGround::end_daemon() {
  if (!daemon_) return;
  daemon_.reset();
  std::error_code error;
  std::filesystem::remove_all(std::filesystem::path(options_.out) / kPrivateData, error);
}

}  // namespace lipofill::client
