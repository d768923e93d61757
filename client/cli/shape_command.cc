#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/application.h"
#include "client/cpp/errors.h"
#include "client/cpp/plan_file.h"
#include "client/cpp/shape_call.h"

namespace lipofill::client {
namespace {

struct Options {
  std::string plan;
  std::string model;
  std::vector<std::string> volumes;
  std::vector<std::string> added;
  bool sensitivities = false;
};

/// Takes "masseter=0.5" apart.
absl::StatusOr<std::pair<std::string, double>> read_volume(const std::string& text, const char* option,
                                                           const char* what) {
  const size_t at = text.rfind('=');
  double volume_ml = 0.0;
  if (at != std::string::npos && at > 0 && absl::SimpleAtod(text.substr(at + 1), &volume_ml)) {
    return std::pair(text.substr(0, at), volume_ml);
  }
  return invalid_fields("no volume", {{option, absl::StrCat("is '", text, "', should be ", what, "=ML")}});
}

absl::Status add_volumes(const Options& options, v1::FindShapeRequest& request) {
  for (const std::string& text : options.volumes) {
    const auto volume = read_volume(text, "--volume", "NUMBER");
    if (!volume.ok()) return volume.status();
    uint32_t number = 0;
    if (!absl::SimpleAtoi(volume->first, &number) || number == 0) {
      return invalid_fields(
          "no injection",
          {{"--volume", absl::StrCat("is of injection '", volume->first, "', should be a number from 1 on")}});
    }
    v1::InjectionVolume& injection = *request.add_injections();
    injection.set_index(number - 1);
    injection.set_volume_ml(volume->second);
  }
  for (const std::string& text : options.added) {
    const auto volume = read_volume(text, "--add", "ZONE");
    if (!volume.ok()) return volume.status();
    v1::AddedFat& added = *request.add_added();
    added.set_zone(volume->first);
    added.set_volume_ml(volume->second);
  }
  return absl::OkStatus();
}

absl::StatusOr<v1::FindShapeRequest> make_request(const Options& options) {
  v1::FindShapeRequest request;
  if (options.plan.starts_with("simulations/")) {
    request.set_simulation(options.plan);
    if (!options.model.empty()) {
      return invalid_fields("a model too many", {{"--model", "is given with a simulation, which has its own"}});
    }
  } else {
    auto plan = load_plan(options.plan);
    if (!plan.ok()) return plan.status();
    if (options.model.empty()) {
      return invalid_fields("no model", {{"--model", "is missing: it says on which model a plan file is tried"}});
    }
    *request.mutable_spec() = plan->plan.simulation();
    request.mutable_spec()->set_model(options.model);
  }
  if (absl::Status added = add_volumes(options, request); !added.ok()) return added;
  request.set_with_sensitivities(options.sensitivities);
  request.add_fields("skin.displacement");
  return request;
}

std::string change_of(const v1::ShapeSensitivity& by) {
  if (by.parameter() == v1::ShapeSensitivity::POOL_VOLUME) return absl::StrCat("1 mL in ", by.name());
  return absl::StrCat(by.parameter() == v1::ShapeSensitivity::LAYER_THICKNESS ? "1 % thicker " : "1 % stiffer ",
                      by.name());
}

std::string describe(const v1::FoundShape& shape) {
  const v1::Summary& summary = shape.summary();
  std::string text = absl::StrFormat(
      "The settled shape, not run and not kept: the skin moves by up to %.2f mm, %.2f mL of fat, up to %.2f kPa.\n",
      summary.skin_max_displacement_mm(), summary.film_volume_ml(), 1e-3 * summary.max_pressure_pa());
  if (shape.volume_share() < 1.0) absl::StrAppend(&text, "It is not whole: ", shape.reason(), ".\n");
  for (const v1::ZoneSummary& zone : summary.zones()) {
    absl::StrAppendFormat(&text, "  zone %-24s %6.2f mL %7.2f kPa, up to %.2f mm thick\n", zone.name(),
                          zone.volume_ml(), 1e-3 * zone.mean_pressure_pa(), zone.max_thickness_mm());
  }
  if (!shape.sensitivities().empty()) text += "A little more of one thing, all others kept:\n";
  for (const v1::ShapeSensitivity& by : shape.sensitivities()) {
    absl::StrAppendFormat(&text, "  %-40s moves the skin by up to %.3f mm and lifts %.3f mL\n", change_of(by),
                          by.max_displacement_mm(), by.skin_volume_ml());
    for (int pool = 0; pool < by.pressure_pa_size(); ++pool) {
      absl::StrAppendFormat(&text, "    pressure in %-26s %+.1f Pa\n", shape.pools(pool).zones(), by.pressure_pa(pool));
    }
  }
  for (const std::string& remark : summary.remarks()) absl::StrAppend(&text, "Worth knowing: ", remark, "\n");
  return text;
}

absl::StatusOr<ExitCode> shape(Application& application, const Options& options) {
  const auto request = make_request(options);
  if (!request.ok()) return request.status();
  const auto found = find_shape(application.connect(), *request);
  if (!found.ok()) return found.status();
  application.answer(found->figures, describe(found->figures));
  return ExitCode::kOk;
}

}  // namespace

void add_shape_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      root, application, "shape",
      "Find the settled shape of a plan at once, with other volumes, without running or keeping anything: what half a "
      "millilitre more would do",
      "  lipofill shape simulations/abc --add masseter=0.5\n"
      "  lipofill shape jaw_angle.json --model patients/case-7/models/abc --volume 1=2.5 --sensitivities\n",
      [&application, options] { return shape(application, *options); });
  command->add_option("plan", options->plan, "simulations/ID, or PLAN.json with --model")->required();
  command->add_option("--model", options->model, "patients/ID/models/ID");
  command->add_option("--volume", options->volumes, "NUMBER=ML: the volume of the plan's injection NUMBER, from 1");
  command->add_option("--add", options->added, "ZONE=ML: fat in a zone beyond the plan's; negative: taken out");
  command->add_flag("--sensitivities", options->sensitivities,
                    "Say what a little more of each volume, stiffness and thickness does");
}

}  // namespace lipofill::client
