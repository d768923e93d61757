#include "tests/integration/chaos/reference.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/simulation/simulation.h"
#include "server/wire/model_conversion.h"
#include "server/wire/simulation_conversion.h"

namespace lipofill::testing {
namespace {

std::unique_ptr<simulation::Simulation> make(const v1::ModelSpec& model, const v1::SimulationSpec& plan) {
  const auto face = server::to_face_model_spec(model);
  if (!face.ok()) return nullptr;
  const auto built = model::build_face_model(*face, [](double, const char*) { return true; });
  const auto spec = server::to_simulation_spec(plan);
  if (!built.ok() || !spec.ok()) return nullptr;
  auto made = simulation::Simulation::create(*built, *spec);
  return made.ok() ? *std::move(made) : nullptr;
}

}  // namespace

Outcome run_unbroken(const v1::ModelSpec& model, const Course& course, uint64_t until_step) {
  const auto simulation = make(model, course.plan);
  if (simulation == nullptr) {
    ADD_FAILURE() << "the plan of the test cannot be run";
    return {};
  }
  size_t next = 0;
  while (true) {
    const uint64_t step = simulation->report().step;
    for (; next < course.injections.size() && course.injections[next].step <= step; ++next) {
      const auto injection = server::to_injection_spec(course.injections[next].injection);
      const absl::Status done = injection.ok() ? simulation->inject(*injection) : injection.status();
      EXPECT_TRUE(done.ok()) << done;
    }
    if (simulation->phase() != simulation::Phase::kRunning || step >= until_step) break;
    simulation->advance_step();
  }
  return {simulation->state_hash(), simulation->report().step};
}

}  // namespace lipofill::testing
