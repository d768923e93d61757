#include <filesystem>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cli/application.h"
#include "client/cli/describe_plans.h"
#include "client/cli/listing.h"
#include "client/cli/options.h"
#include "client/cpp/json_file.h"
#include "client/cpp/json_message.h"
#include "client/cpp/plan_file.h"
#include "lipofill/v1/plan_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::PlanService;
using Stub = PlanService::Stub;

struct Options {
  std::string name;
  std::string patient;
  std::string file;
  std::string id;
  std::string request_id;
  std::string scan;
  std::string title;
  std::string etag;
  std::string out;
  uint64_t revision = 0;
  std::optional<v1::PlanSide> side;
};

const std::map<std::string, v1::PlanSide> kSides = {
    {"left", v1::LEFT_SIDE}, {"right", v1::RIGHT_SIDE}, {"both", v1::BOTH_SIDES}};

/// The plan of a file as the daemon keeps it: with its landmarks, without the files it names.
absl::StatusOr<v1::SavedPlan> read_plan(const Options& options) {
  auto file = load_plan(options.file);
  if (!file.ok()) return file.status();
  if (auto status = load_plan_landmarks(&*file); !status.ok()) return status;
  v1::SavedPlan plan;
  *plan.mutable_content() = file->plan;
  plan.mutable_content()->clear_scan();
  plan.mutable_content()->clear_bone();
  plan.set_title(options.title.empty() ? display_name_of(file->plan.name()) : options.title);
  plan.set_scan(options.scan.empty() ? file->plan.model().scan_region().scan() : options.scan);
  if (options.side) plan.set_side(*options.side);
  return plan;
}

/// Puts a plan on its scan. INVALID_ARGUMENT for the plan of a face without one.
absl::Status place_on_scan(v1::SavedPlan& plan) {
  if (!plan.content().model().has_scan_region()) return absl::OkStatus();
  if (plan.scan().empty()) return absl::InvalidArgumentError("--scan is missing: the plan is for a face");
  plan.mutable_content()->mutable_model()->mutable_scan_region()->set_scan(plan.scan());
  return absl::OkStatus();
}

absl::StatusOr<v1::SavedPlan> get_plan(const Connection& connection, const Options& options) {
  if (options.revision > 0) {
    v1::GetPlanRevisionRequest request;
    request.set_name(options.name);
    request.set_revision(options.revision);
    return connection.call<PlanService>(&Stub::GetPlanRevision, request);
  }
  v1::GetPlanRequest request;
  request.set_name(options.name);
  return connection.call<PlanService>(&Stub::GetPlan, request);
}

/// Replaces the plan that `--to` names; what is not given on the command line stays.
absl::StatusOr<v1::SavedPlan> replace(const Connection& connection, const Options& options, v1::SavedPlan plan) {
  const auto present = get_plan(connection, options);
  if (!present.ok()) return present;
  if (options.title.empty()) plan.set_title(present->title());
  if (!options.side) plan.set_side(present->side());
  if (options.scan.empty() && plan.scan().empty()) plan.set_scan(present->scan());
  if (auto placed = place_on_scan(plan); !placed.ok()) return placed;
  plan.set_target_scan(present->target_scan());
  plan.set_name(options.name);
  plan.set_etag(options.etag.empty() ? present->etag() : options.etag);
  v1::UpdatePlanRequest request;
  *request.mutable_plan() = std::move(plan);
  return connection.call<PlanService>(&Stub::UpdatePlan, request);
}

absl::StatusOr<ExitCode> save(Application& application, const Options& options) {
  if (options.patient.empty() == options.name.empty()) {
    return absl::InvalidArgumentError("say either --patient, for a new plan, or --to, for one that is there");
  }
  auto plan = read_plan(options);
  if (!plan.ok()) return plan.status();
  if (options.name.empty()) {
    if (auto placed = place_on_scan(*plan); !placed.ok()) return placed;
  }
  const Connection connection = application.connect();
  absl::StatusOr<v1::SavedPlan> saved;
  if (options.name.empty()) {
    v1::CreatePlanRequest request;
    request.set_parent(full_name("patients", options.patient));
    request.set_plan_id(options.id);
    request.set_request_id(options.request_id);
    *request.mutable_plan() = *std::move(plan);
    saved = connection.call<PlanService>(&Stub::CreatePlan, request);
  } else {
    saved = replace(connection, options, *std::move(plan));
  }
  if (!saved.ok()) return saved.status();
  return application.answer(*saved, describe(*saved));
}

absl::StatusOr<ExitCode> show(Application& application, const Options& options) {
  const auto plan = get_plan(application.connect(), options);
  if (!plan.ok()) return plan.status();
  if (options.out.empty()) return application.answer(*plan, describe(*plan));
  if (auto written = write_text_file(options.out, compact_message_json(plan->content()) + "\n"); !written.ok()) {
    return written;
  }
  return application.done(absl::StrCat("wrote ", options.out));
}

absl::StatusOr<ExitCode> list(Application& application, const Options& options) {
  v1::ListPlansRequest request;
  request.set_parent(options.patient.empty() ? "patients/-" : full_name("patients", options.patient));
  const auto all = list_all<PlanService>(application.connect(), &Stub::ListPlans, request,
                                         [](v1::ListPlansResponse& response) { return response.mutable_plans(); });
  if (!all.ok()) return all.status();
  std::string text;
  for (const v1::SavedPlan& plan : all->plans()) text += list_line(plan);
  text += unreachable_lines(*all);
  return application.answer(*all, text);
}

absl::StatusOr<ExitCode> history(Application& application, const Options& options) {
  v1::ListPlanRevisionsRequest request;
  request.set_parent(options.name);
  const auto all =
      list_all<PlanService>(application.connect(), &Stub::ListPlanRevisions, request,
                            [](v1::ListPlanRevisionsResponse& response) { return response.mutable_revisions(); });
  if (!all.ok()) return all.status();
  std::string text;
  for (const v1::PlanRevision& revision : all->revisions()) text += describe(revision);
  return application.answer(*all, text);
}

absl::StatusOr<ExitCode> remove(Application& application, const Options& options) {
  v1::DeletePlanRequest request;
  request.set_name(options.name);
  request.set_etag(options.etag);
  const auto deleted = application.connect().call<PlanService>(&Stub::DeletePlan, request);
  if (!deleted.ok()) return deleted.status();
  return application.done(absl::StrCat("deleted ", request.name()));
}

void add_name(CLI::App* command, Options& options) {
  command->add_option("name", options.name, "patients/ID/plans/ID")->required();
}

void add_save(CLI::App& group, Application& application, const std::shared_ptr<Options>& options) {
  CLI::App* command = add_command(
      group, application, "save",
      "Keep a plan with a patient on the daemon, where everybody who works on the case finds it. Its landmarks go with "
      "it; the scan is one that the daemon has",
      "  lipofill plan save jaw_angle.json --patient case-7 --scan patients/case-7/scans/abc --side left\n"
      "  lipofill plan save jaw_angle.json --to patients/case-7/plans/def\n",
      [&application, options] { return save(application, *options); });
  command->add_option("plan", options->file, "PLAN.json")->required();
  command->add_option("--patient", options->patient, "patients/ID, or the ID alone: keep it as a new plan");
  command->add_option("--to", options->name,
                      "patients/ID/plans/ID: replace this one; what it was stays in its history");
  command->add_option("--id", options->id, "the last part of a new plan's name; made up when absent");
  command->add_option("--request-id", options->request_id, "a repeated call with the same one makes no second plan");
  command->add_option("--scan", options->scan, "patients/ID/scans/ID: the face that it is for");
  command->add_option("--title", options->title, "a pseudonym, never a person's name: [a-z0-9-]");
  command->add_option("--side", options->side, "left, right or both")->transform(choice_of(kSides));
  command->add_option("--etag", options->etag, "replace only what has this etag, as `plan show` tells it");
}

}  // namespace

void add_saved_plan_commands(CLI::App& group, Application& application) {
  const auto options = std::make_shared<Options>();
  add_save(group, application, options);
  CLI::App* command =
      add_command(group, application, "list", "List the plans that are kept, of one patient or of all",
                  "  lipofill plan list case-7\n", [&application, options] { return list(application, *options); });
  command->add_option("patient", options->patient, "patients/ID, or the ID alone; absent: all");
  command = add_command(group, application, "show", "Show a plan that is kept, or write it to a file",
                        "  lipofill plan show patients/case-7/plans/def\n"
                        "  lipofill plan show patients/case-7/plans/def --revision 3 --out earlier.json\n",
                        [&application, options] { return show(application, *options); });
  add_name(command, *options);
  command->add_option("--revision", options->revision, "as it was then; see `plan history`")
      ->check(CLI::PositiveNumber);
  command->add_option("--out", options->out, "write the plan file here");
  add_name(add_command(group, application, "history", "Tell what a plan was, the newest first, and what changed",
                       "  lipofill plan history patients/case-7/plans/def\n",
                       [&application, options] { return history(application, *options); }),
           *options);
  command = add_command(group, application, "delete", "Delete a plan with its history; what was run from it stays",
                        "  lipofill plan delete patients/case-7/plans/def\n",
                        [&application, options] { return remove(application, *options); });
  add_name(command, *options);
  command->add_option("--etag", options->etag, "delete only what has this etag");
}

}  // namespace lipofill::client
