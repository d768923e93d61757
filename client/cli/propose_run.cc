#include "client/cli/propose_run.h"

#include <filesystem>
#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/json_file.h"
#include "client/cpp/json_message.h"
#include "client/cpp/model_build.h"
#include "lipofill/v1/planning_service.grpc.pb.h"

namespace lipofill::client {
namespace {

/// The plan as a file beside the results: the model as it was built, the plan as it was proposed,
/// files named from there.
v1::Plan plan_file_of(const PlanFile& from, const v1::Model& model, const v1::SimulationSpec& proposed,
                      const std::filesystem::path& folder) {
  v1::Plan plan = from.plan;
  const auto name_from_there = [&](const std::optional<std::filesystem::path>& file, v1::ScanFile* scan) {
    if (!file) return;
    std::error_code error;
    const auto relative = std::filesystem::relative(*file, folder, error);
    scan->set_file(error || relative.empty() ? std::filesystem::absolute(*file).string() : relative.string());
    scan->clear_landmarks_file();  // the model has them
  };
  if (from.scan_file) name_from_there(from.scan_file, plan.mutable_scan());
  if (from.bone_file) name_from_there(from.bone_file, plan.mutable_bone());
  *plan.mutable_model() = model.spec();
  if (plan.model().has_scan_region()) {
    plan.mutable_model()->mutable_scan_region()->clear_scan();
    plan.mutable_model()->mutable_scan_region()->clear_bone_scan();
  }
  *plan.mutable_simulation() = proposed;
  plan.mutable_simulation()->clear_model();
  return plan;
}

bool is_on_daemon(const std::string& surface) {
  return surface.starts_with("patients/");
}

void append_volume(const v1::ProposedVolume& volume, std::string& text) {
  absl::StrAppendFormat(&text, "  %-24s below %-14s %8.3f mL +- %.3f  %7.0f Pa%s%s\n", volume.zone(),
                        volume.below_layer(), volume.volume_ml(), volume.standard_error_ml(), volume.pressure_pa(),
                        volume.bound().empty() ? "" : absl::StrCat("  held by ", volume.bound()),
                        volume.proposed_zone() ? "  (proposed)" : "");
}

}  // namespace

std::string describe(const v1::Proposal& proposal) {
  std::string text = absl::StrFormat("%.3f mL in %d zones\n", proposal.total_ml(), proposal.volumes_size());
  for (const v1::ProposedVolume& volume : proposal.volumes()) append_volume(volume, text);
  const v1::DistanceStatistics& before = proposal.before().skin_to_target();
  const v1::DistanceStatistics& reached = proposal.reached().skin_to_target();
  absl::StrAppendFormat(&text, "skin that lacks something, to the target: rms %.2f -> %.2f mm, p95 %.2f -> %.2f mm\n",
                        before.rms_mm(), reached.rms_mm(), before.p95_mm(), reached.p95_mm());
  absl::StrAppendFormat(&text, "missing %.2f -> %.2f mL; the skin moves by up to %.2f mm\n",
                        proposal.before().volume().deficit_ml(), proposal.reached().volume().deficit_ml(),
                        proposal.max_lift_mm());
  for (const v1::Remainder& remainder : proposal.remainders()) {
    absl::StrAppend(&text, "left: ", remainder.description(), "\n");
  }
  if (proposal.has_robustness()) {
    const v1::Robustness& held = proposal.robustness();
    absl::StrAppendFormat(&text,
                          "holds in %d of %d cases of tissue, up to %.0f Pa; without that %d cases, %.3f mL, rms %.2f "
                          "mm\n",
                          held.members_below(), held.members(), held.pressure_quantile_pa(),
                          held.nominal_members_below(), held.nominal_total_ml(), held.nominal_rms_mm());
  }
  for (const v1::TradeOff& point : proposal.curve()) {
    absl::StrAppendFormat(&text, "curve: %8.3f mL  %7.0f Pa  rms %.2f mm\n", point.total_ml(), point.max_pressure_pa(),
                          point.rms_mm());
  }
  for (const std::string& remark : proposal.remarks()) absl::StrAppend(&text, "remark: ", remark, "\n");
  absl::StrAppendFormat(&text, "%d solves, %d factorisations, %.1f s\n", proposal.solves(), proposal.factorisations(),
                        proposal.wall_s());
  return text;
}

ProposeRun::ProposeRun(Application& application, ProposeOptions options)
    : application_(application),
      options_(std::move(options)),
      progress_(options_.quiet),
      ground_(application, options_, progress_) {}

absl::StatusOr<ExitCode> ProposeRun::carry_out() {
  absl::Status status;
  for (const auto step :
       {&ProposeRun::read_plan, &ProposeRun::prepare_ground, &ProposeRun::send_target, &ProposeRun::propose}) {
    status = (this->*step)();
    if (!status.ok()) break;
  }
  progress_.finish();
  if (status.ok()) status = write_results();
  if (!status.ok() || !options_.keep) {
    ground_.delete_patient();
    ground_.end_daemon();
  }
  if (!status.ok()) return status;
  print();
  return ExitCode::kOk;
}

absl::Status ProposeRun::read_plan() {
  std::error_code error;
  std::filesystem::create_directories(options_.out, error);
  if (error)
    return absl::InvalidArgumentError(absl::StrCat("cannot make the folder ", options_.out, ": ", error.message()));
  // Said before a model is built for it.
  if (!is_on_daemon(options_.target) && !std::filesystem::is_regular_file(options_.target, error)) {
    return absl::InvalidArgumentError(absl::StrCat("--target: ", options_.target, " does not exist or is not a file"));
  }
  return ground_.read_plan();
}

absl::Status ProposeRun::prepare_ground() {
  for (const auto step :
       {&RunGround::reach_daemon, &RunGround::prepare_patient, &RunGround::send_scan, &RunGround::build}) {
    if (const absl::Status status = (ground_.*step)(); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status ProposeRun::send_target() {
  target_ = options_.target;
  if (is_on_daemon(target_)) return absl::OkStatus();
  const auto scan = ground_.send_surface(options_.target, options_.target_unit, "target");
  if (scan.ok()) target_ = scan->name();
  return scan.status();
}

absl::Status ProposeRun::propose() {
  v1::ProposePlanRequest request;
  request.set_parent(ground_.patient());
  *request.mutable_spec() = options_.spec;
  *request.mutable_spec()->mutable_plan() = ground_.plan().plan.simulation();
  request.mutable_spec()->mutable_plan()->set_model(ground_.model().name());
  request.mutable_spec()->set_target_scan(target_);
  auto operation = ground_.connection().call<v1::PlanningService>(&v1::PlanningService::Stub::ProposePlan, request);
  if (!operation.ok()) return operation.status();
  return finish_operation(
      ground_.connection(), *operation,
      [this](const std::string& stage, double fraction) {
        progress_.show(absl::StrFormat("proposing: %.0f %%  %s", 100.0 * fraction, stage));
      },
      &proposal_);
}

absl::Status ProposeRun::write_results() const {
  const std::filesystem::path folder = options_.out;
  const v1::Plan plan = plan_file_of(ground_.plan(), ground_.model(), proposal_.plan(), folder);
  if (auto status = write_text_file(folder / "plan.json", compact_message_json(plan)); !status.ok()) return status;
  return write_text_file(folder / "proposal.json", message_json(proposal_));
}

void ProposeRun::print() const {
  if (application_.json) {
    std::cout << message_json(proposal_) << "\n" << std::flush;
  } else if (!options_.quiet) {
    std::cout << describe(proposal_) << "plan.json and proposal.json in " << options_.out << "\n" << std::flush;
  }
}

}  // namespace lipofill::client
