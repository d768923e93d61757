#include "client/cli/forecast_command.h"

#include <iostream>
#include <map>
#include <memory>

#include "client/cli/application.h"
#include "client/cli/forecast_run.h"
#include "client/cli/options.h"
#include "client/cpp/json_message.h"
#include "lipofill/v1/forecast_service.grpc.pb.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "Forecast a plan: its settled shape in many cases of tissue, delivered volume, place and retention, at once and "
    "after months. Says the middle and the interval of every figure, how likely each band of pressure is, what causes "
    "the spread, how much to inject so that a volume remains, and in how many sessions. Writes forecast.json into the "
    "folder, with the mean displacement and the interval of the lift at every vertex. Progress goes to the error "
    "output. Ctrl-C cancels.";

constexpr char kExamples[] =
    "  lipofill forecast jaw_angle.json --out forecast --spawn\n"
    "  lipofill forecast jaw_angle.json --out forecast --spawn --members 1000 --month 3 --month 12 --retention "
    "centrifuge\n"
    "  lipofill forecast jaw_angle.json --out forecast --spawn --follow-up-month 3 --skin-volume-ml 2.1 "
    "--standard-error-ml 0.3\n"
    "  lipofill forecast jaw_angle.json --out forecast --spawn --settings uncertain.json\n"
    "where uncertain.json holds a ForecastSpec, for example\n"
    "  {\"inputs\": [{\"quantity\": \"LAYER_MODULUS\", \"name\": \"skin\", \"source\": \"elastography of this "
    "patient\",\n"
    "    \"distribution\": {\"law\": \"LOG_NORMAL\", \"centre\": 1.1, \"spread\": 0.1}}]}\n";

constexpr char kRetentionDescription[] =
    "Tell how much of injected fat is left after months, with the interval that 90 of 100 patients lie in; after a "
    "follow-up, what is known then; and how much to inject so that a volume is left. Needs neither plan nor model.";

constexpr char kRetentionExamples[] =
    "  lipofill retention\n"
    "  lipofill retention --retention cotton_pad --month 12 --wanted-ml 5\n"
    "  lipofill retention --injected-ml 10 --follow-up-month 3 --kept-ml 6 --standard-error-ml 0.5\n";

const std::map<std::string, v1::Retention::Preset> kPresets = {
    {"pooled", v1::Retention::POOLED},
    {"acquired_atrophy", v1::Retention::ACQUIRED_ATROPHY},
    {"mixed_indications", v1::Retention::MIXED_INDICATIONS},
    {"cotton_pad", v1::Retention::COTTON_PAD},
    {"centrifuge", v1::Retention::CENTRIFUGE},
};

/// Options that both commands have. `message` gives the message with retention, months, follow_up.
template <typename Message>
void add_retention_options(CLI::App& command, Message message) {
  add_field<v1::Retention::Preset>(
      command, "--retention", "pooled (default), acquired_atrophy, mixed_indications, cotton_pad or centrifuge",
      [message](v1::Retention::Preset preset) { message()->mutable_retention()->set_preset(preset); })
      ->transform(choice_of(kPresets));
  add_field<double>(command, "--retention-sd", "standard deviation of the share after 12 months, patient to patient",
                    [message](double value) { message()->mutable_retention()->set_standard_deviation(value); });
  add_field<std::vector<double>>(command, "--month", "a month to tell of; may be repeated (default 1, 3, 6, 12)",
                                 [message](const std::vector<double>& months) {
                                   message()->mutable_months()->Assign(months.begin(), months.end());
                                 });
  add_field<double>(command, "--follow-up-month", "when a follow-up was",
                    [message](double value) { message()->mutable_follow_up()->set_month(value); });
  add_field<double>(command, "--kept-ml", "fat that the follow-up found left",
                    [message](double value) { message()->mutable_follow_up()->set_kept_ml(value); });
  add_field<double>(command, "--standard-error-ml", "standard deviation of what the follow-up measured",
                    [message](double value) { message()->mutable_follow_up()->set_standard_error_ml(value); });
}

void add_retention_command(CLI::App& root, Application& application) {
  const auto request = std::make_shared<v1::EstimateRetentionRequest>();
  CLI::App* command = add_command(
      root, application, "retention", kRetentionDescription, kRetentionExamples,
      [&application, request]() -> absl::StatusOr<ExitCode> {
        const auto estimate =
            application.connect().call<v1::ForecastService>(&v1::ForecastService::Stub::EstimateRetention, *request);
        if (!estimate.ok()) return estimate.status();
        std::cout << (application.json ? message_json(*estimate) + "\n" : describe(*estimate)) << std::flush;
        return ExitCode::kOk;
      });
  add_retention_options(*command, [request] { return request.get(); });
  add_field<double>(*command, "--injected-ml", "all that was injected; needed with a follow-up",
                    [request](double value) { request->set_injected_ml(value); });
  add_field<double>(*command, "--wanted-ml", "volume that is to be left after the last month",
                    [request](double value) { request->set_wanted_ml(value); });
}

}  // namespace

void add_forecast_options(CLI::App& command, const std::function<v1::ForecastSpec*()>& spec) {
  add_retention_options(command, spec);
  add_field<uint32_t>(command, "--members", "cases that are solved (default 500)",
                      [spec](uint32_t value) { spec()->set_members(value); });
  add_field<double>(command, "--skin-volume-ml", "volume that the skin has gained by the follow-up",
                    [spec](double value) { spec()->mutable_follow_up()->set_skin_volume_ml(value); });
  add_field<double>(command, "--session-band-mmhg", "a session fills a zone up to this pressure (default 30)",
                    [spec](double value) { spec()->set_session_band_mmhg(value); });
  add_field<double>(command, "--months-between", "months from one session to the next (default 6)",
                    [spec](double value) { spec()->set_months_between_sessions(value); });
}

void add_forecast_commands(CLI::App& root, Application& application) {
  const auto options = std::make_shared<ForecastOptions>();
  CLI::App* command = add_command(root, application, "forecast", kDescription, kExamples,
                                  [&application, options] { return ForecastRun(application, *options).carry_out(); });
  add_plan_work_options(*command, *options);
  command->add_option("--settings", options->settings, "a JSON file with a ForecastSpec: inputs and the rest");
  add_forecast_options(*command, [options] { return &options->spec; });
  command->add_flag_function(
      "--figures-only", [options](int64_t) { options->spec.set_figures_only(true); },
      "leave out the values of every vertex");
  add_retention_command(root, application);
}

}  // namespace lipofill::client
