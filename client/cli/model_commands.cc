#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/application.h"
#include "client/cli/describe.h"
#include "client/cli/listing.h"
#include "client/cli/progress_line.h"
#include "client/cpp/frame_watcher.h"
#include "client/cpp/io/result_folder.h"
#include "client/cpp/model_build.h"
#include "client/cpp/plan_file.h"
#include "client/cpp/scan_upload.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::PatientService;
using Stub = PatientService::Stub;

struct Options {
  std::string name;
  std::string patient;
  std::string plan;
  std::string scan;
  std::string bone;
  std::string out;
};

/// The plan's model; its scans of skin and bone are those named, or are sent first.
absl::StatusOr<v1::ModelSpec> model_of_plan(const Connection& connection, const Options& options,
                                            const std::string& parent) {
  auto plan = load_plan(options.plan);
  if (!plan.ok()) return plan.status();
  if (auto status = load_plan_landmarks(&*plan); !status.ok()) return status;
  if (auto status = check_bone_file(*plan); !status.ok()) return status;
  take_region_from_zones(&plan->plan);
  v1::ModelSpec spec = plan->plan.model();
  if (!options.scan.empty()) {
    spec.mutable_scan_region()->set_scan(options.scan);
  } else if (plan->scan_file) {
    const auto scan = upload_scan(connection, parent, *plan->scan_file, plan->plan.scan().unit());
    if (!scan.ok()) return scan.status();
    spec.mutable_scan_region()->set_scan(scan->name());
  }
  if (!options.bone.empty()) {
    spec.mutable_scan_region()->set_bone_scan(options.bone);
  } else if (plan->bone_file) {
    const auto bone = upload_scan(connection, parent, *plan->bone_file, plan->plan.bone().unit());
    if (!bone.ok()) return bone.status();
    spec.mutable_scan_region()->set_bone_scan(bone->name());
  }
  return spec;
}

absl::StatusOr<ExitCode> build(Application& application, const Options& options) {
  const Connection connection = application.connect();
  v1::BuildModelRequest request;
  request.set_parent(full_name("patients", options.patient));
  auto spec = model_of_plan(connection, options, request.parent());
  if (!spec.ok()) return spec.status();
  *request.mutable_spec() = *std::move(spec);
  ProgressLine progress(application.json);
  const auto model = build_model(connection, request, [&progress](const std::string& stage, double fraction) {
    progress.show(absl::StrFormat("building %3.0f %%  %s", 100.0 * fraction, stage));
  });
  progress.finish();
  if (!model.ok()) return model.status();
  return application.answer(*model, describe(*model));
}

absl::StatusOr<ExitCode> get(Application& application, const Options& options) {
  v1::GetModelRequest request;
  request.set_name(options.name);
  const auto model = application.connect().call<PatientService>(&Stub::GetModel, request);
  if (!model.ok()) return model.status();
  return application.answer(*model, describe(*model));
}

absl::StatusOr<ExitCode> list(Application& application, const Options& options) {
  v1::ListModelsRequest request;
  request.set_parent(full_name("patients", options.patient));
  const auto all = list_all<PatientService>(application.connect(), &Stub::ListModels, request,
                                            [](v1::ListModelsResponse& response) { return response.mutable_models(); });
  if (!all.ok()) return all.status();
  std::string text;
  for (const v1::Model& model : all->models()) text += list_line(model);
  text += unreachable_lines(*all);
  return application.answer(*all, text);
}

absl::StatusOr<ExitCode> remove(Application& application, const Options& options) {
  v1::DeleteModelRequest request;
  request.set_name(options.name);
  const auto deleted = application.connect().call<PatientService>(&Stub::DeleteModel, request);
  if (!deleted.ok()) return deleted.status();
  return application.done(absl::StrCat("deleted ", request.name()));
}

absl::StatusOr<ExitCode> mesh(Application& application, const Options& options) {
  auto meshes = download_model_mesh(application.connect(), options.name);
  if (!meshes.ok()) return meshes.status();
  ResultFolder folder(options.out);
  if (auto status = folder.prepare(); !status.ok()) return status;
  folder.set_meshes(std::move(meshes->arrays));
  if (auto status = folder.write_frame(0.0, {}); !status.ok()) return status;
  return application.done(absl::StrCat("wrote the meshes at rest to ", options.out));
}

}  // namespace

void add_model_commands(CLI::App& root, Application& application) {
  CLI::App* group = add_group(root, "model", "Layered face models");
  const auto options = std::make_shared<Options>();
  const auto add_named = [&](const char* word, const char* description, const char* example, auto action) {
    CLI::App* command = add_command(*group, application, word, description, example,
                                    [&application, options, action] { return action(application, *options); });
    command->add_option("model", options->name, "patients/ID/models/ID")->required();
    return command;
  };
  CLI::App* command = add_command(*group, application, "build", "Build the model of a plan and wait for it",
                                  "  lipofill model build case-7 jaw_angle.json\n"
                                  "  lipofill model build case-7 jaw_angle.json --scan patients/case-7/scans/abc\n",
                                  [&application, options] { return build(application, *options); });
  command->add_option("patient", options->patient, "patients/ID, or the ID alone")->required();
  command->add_option("plan", options->plan, "PLAN.json")->required();
  command->add_option("--scan", options->scan, "a scan the daemon has, in place of the plan's file");
  command->add_option("--bone", options->bone, "a scan of the bone the daemon has, in place of the plan's file");
  add_command(*group, application, "list", "List a patient's models", "  lipofill model list case-7\n",
              [&application, options] { return list(application, *options); })
      ->add_option("patient", options->patient, "patients/ID, or the ID alone")
      ->required();
  add_named("get", "Show a model", "  lipofill model get patients/case-7/models/abc\n", get);
  add_named("delete", "Delete a model; its simulations keep their results",
            "  lipofill model delete patients/case-7/models/abc\n", remove);
  add_named("mesh", "Write a model's meshes at rest for ParaView",
            "  lipofill model mesh patients/case-7/models/abc --out rest\n", mesh)
      ->add_option("--out", options->out, "folder")
      ->required();
}

}  // namespace lipofill::client
