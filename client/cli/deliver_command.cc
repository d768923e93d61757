#include <memory>

#include "client/cli/application.h"
#include "client/cli/deliver_run.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "List how a plan's volumes are laid by hand: where the cannula goes in, the tunnels of its fan, and the volume of "
    "every pass, in their order. Writes into the folder: passes.csv, a pass a line; delivery.json, the same with the "
    "whole of each tunnel; plan.json, the plan with the fat laid along the tunnels, which lipofill run takes.";

constexpr char kExamples[] =
    "  lipofill deliver jaw_angle.json --out list --spawn\n"
    "  lipofill deliver jaw_angle.json --out list --spawn --max-pass-ml 0.05 --tunnel-spacing-mm 3\n"
    "  lipofill deliver jaw_angle.json --out list --spawn --compare\n"
    "  lipofill propose jaw_angle.json --target goal.obj --out proposed --spawn && lipofill deliver "
    "proposed/plan.json --out list --spawn\n";

}  // namespace

void add_deliver_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<DeliverOptions>();
  CLI::App* command = add_command(root, application, "deliver", kDescription, kExamples,
                                  [&application, options] { return DeliverRun(application, *options).carry_out(); });
  add_plan_work_options(*command, *options);
  command->add_option("--max-pass-ml", options->max_pass_ml,
                      "a pass lays at most this (default 0.1, which is the most)");
  command->add_option("--tunnel-spacing-mm", options->tunnel_spacing_mm,
                      "between the ends of neighbouring tunnels, 2 to 20 (default 5)");
  command->add_flag("--compare", options->compare,
                    "find the settled shape of the plan and of the fat as it is laid, and say how far they differ");
}

}  // namespace lipofill::client
