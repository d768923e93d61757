#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/application.h"
#include "client/cli/listing.h"
#include "client/cli/simulation_calls.h"
#include "client/cpp/result_text.h"

namespace lipofill::client {
namespace {

/// There are two, so that one is on its way while the other is told.
constexpr uint32_t kFramesAhead = 2;

struct Options {
  std::string simulation;
  double interval_ms = 0.0;
  std::optional<double> max_rate_hz;
  bool every = false;
  bool compact = false;
};

/// The largest length of a field's rows; 0 without the field.
double largest(const std::vector<Array>& fields, std::string_view name) {
  const Array* field = find_array(fields, name);
  if (field == nullptr || field->type != ElementType::kFloat32) return 0.0;
  const auto values = field->floats();
  double squares = 0.0;
  for (size_t row = 0; row < field->rows(); ++row) {
    double sum = 0.0;
    for (size_t c = 0; c < field->columns(); ++c) {
      const double value = values[row * field->columns() + c];
      sum += value * value;
    }
    squares = std::max(squares, sum);
  }
  return std::sqrt(squares);
}

void print_frame(const Application& application, const Frame& frame) {
  const double displacement = largest(frame.fields, "skin.displacement");
  const double pressure = largest(frame.fields, "skin.pressure");
  if (!application.json) {
    std::cout << absl::StrFormat(
                     "%s %d  %.3f s  skin %.3f mm  pressure up to %.3f kPa%s%s\n",
                     frame.preview ? "preview at step" : "step", frame.sequence, frame.time_s, displacement,
                     pressure / 1e3,
                     frame.skipped_frames > 0 ? absl::StrCat("  (", frame.skipped_frames, " frames skipped)") : "",
                     frame.end ? "  end" : "")
              << std::flush;
    return;
  }
  const nlohmann::ordered_json line = {{"epoch", frame.epoch},
                                       {"step", frame.sequence},
                                       {"time_s", frame.time_s},
                                       {"skipped_frames", frame.skipped_frames},
                                       {"skin_max_displacement_mm", displacement},
                                       {"skin_max_pressure_pa", pressure},
                                       {"end", frame.end},
                                       {"preview", frame.preview}};
  std::cout << line.dump() << "\n" << std::flush;
}

absl::StatusOr<ExitCode> watch_simulation(Application& application, const Options& options) {
  const Connection connection = application.connect();
  v1::WatchRequest request;
  request.set_simulation(full_name("simulations", options.simulation));
  request.set_delivery(options.every ? v1::WatchRequest::EVERY : v1::WatchRequest::LATEST);
  if (!options.every) request.set_max_unacknowledged_frames(kFramesAhead);
  request.add_fields("skin.displacement");
  request.add_fields("skin.pressure");
  if (options.max_rate_hz) request.set_max_rate_hz(*options.max_rate_hz);
  if (options.compact) request.set_field_type(v1::UINT16);
  if (options.interval_ms > 0.0) request.set_interval_ms(options.interval_ms);
  WatchHandlers handlers;
  handlers.on_meshes = [](const Meshes&) { return absl::OkStatus(); };
  handlers.on_frame = [&application](const Frame& frame) {
    print_frame(application, frame);
    return absl::OkStatus();
  };
  if (auto status = watch(connection, request, handlers); !status.ok()) return status;
  const auto simulation = get_simulation(connection, request.simulation());
  if (!simulation.ok()) return simulation.status();
  if (!application.json) std::cout << summary_text(simulation->name(), *simulation);
  return simulation->state() == v1::Simulation::FAILED ? ExitCode::kGoalNotReached : ExitCode::kOk;
}

}  // namespace

void add_watch_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_command(root, application, "watch",
                                  "Follow a simulation to its end, a line a frame (--json: an object a line)",
                                  "  lipofill watch abc\n"
                                  "  lipofill watch abc --max-rate-hz 5 --compact\n"
                                  "  lipofill watch abc --every --interval-ms 100 --json\n",
                                  [&application, options] { return watch_simulation(application, *options); });
  command->add_option("simulation", options->simulation, "simulations/ID, or the ID alone")->required();
  command->add_option("--interval-ms", options->interval_ms, "simulated time between frames; default: every step")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--max-rate-hz", options->max_rate_hz,
                   "at most so many frames a second of the clock; 0: no bound; default: 60, less of many viewers; no "
                   "bound with --every")
      ->check(CLI::Range(0.0, 1000.0));
  command->add_flag("--compact", options->compact, "16-bit fields: half the bytes, good to 1/130,000 of their range");
  command->add_flag("--every", options->every, "no frame is left out, however slow the reader");
}

}  // namespace lipofill::client
