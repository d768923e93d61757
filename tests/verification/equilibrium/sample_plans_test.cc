// Sample plans found directly, against the same plans stepped until next to nothing is left to go.

#include <gtest/gtest.h>

#include "tests/verification/coupling/jaw_case.h"
#include "tests/verification/equilibrium/direct_case.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

TEST(Driver, Plan) {
  const char* name = std::getenv("PLAN");
  JawPlan plan = load_sample_plan(std::string(name ? name : "jaw_angle") + ".json");
  ASSERT_TRUE(plan.ok);
  if (getenv("FACTOR")) for (auto& i : plan.simulation.injections) i.volume *= atof(getenv("FACTOR"));
  auto model = model::build_face_model(plan.model, nullptr);
  ASSERT_TRUE(model.ok());
  DirectCase direct(*model, plan.simulation);
  for (const double tolerance : {1e-3, 1e-4}) {
    const mechanics::StepCost before = direct.cost();
    const equilibrium::Settled s = direct.solve(tolerance);
    const auto& c = direct.cost().times;
    std::printf("tol %g: share %g factors %d iterations %d closed %zu error %.2e double %d %s\n", tolerance, s.share,
                s.cost.factors, s.cost.iterations, s.closed.size(), s.force_error, s.is_double, s.reason.c_str());
    std::printf("   solves %d element %.1f factor %.1f solve %.1f ms\n",
                direct.cost().tissue_solves - before.tissue_solves, 1e3 * (c.element - before.times.element),
                1e3 * (c.factor - before.times.factor), 1e3 * (c.solve - before.times.solve));
    for (int k = 0; k < direct.pools().n(); ++k)
      std::printf("   %s p %.3f V %.6f mL\n", direct.pools().names[k].c_str(), s.pool_head[k], 1e6 * s.pool_volume[k]);
  }
  const auto best = direct.solve(1e-6);
  for (const double tolerance : {1e-2, 1e-3, 1e-4})
    std::printf("tol %g skin off %.2e mm\n", tolerance,
                1e3 * (direct.skin(direct.solve(tolerance)) - direct.skin(best)).colwise().norm().maxCoeff());
  if (std::getenv("STEP") == nullptr) return;
  auto stepped = step_until_at_rest(*model, plan.simulation, 1e-6);
  std::printf("stepped: %d steps, difference %.4e mm of %.3f\n", (int)stepped->report().step,
              1e3 * (direct.skin(best) - skin_of(*stepped)).colwise().norm().maxCoeff(),
              1e3 * stepped->report().skin_max_displacement);
  for (const auto& zone : stepped->zone_reports())
    std::printf("  %s p %.3f V %.6f\n", zone.name.c_str(), zone.mean_pressure, 1e6 * zone.volume);
}

}  // namespace
}  // namespace lipofill::verification
