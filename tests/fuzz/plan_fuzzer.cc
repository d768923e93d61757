// A plan on its way from its file to what the solver takes: the client's parser, then the daemon's
// checks.

#include "client/cpp/plan_file.h"
#include "core/plan/plan_checks.h"
#include "server/wire/message_check.h"
#include "server/wire/model_conversion.h"
#include "server/wire/simulation_conversion.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto file = lipofill::fuzz::write_scratch_file("plan.json", lipofill::fuzz::as_text(data, size));
  const auto plan = lipofill::client::load_plan(file);
  if (!plan.ok() || !lipofill::server::check_message(plan->plan).ok()) return 0;
  (void)lipofill::server::to_face_model_spec(plan->plan.model());
  const auto spec = lipofill::server::to_simulation_spec(plan->plan.simulation());
  if (spec.ok()) (void)lipofill::plan::check_plan(*spec);
  return 0;
}
