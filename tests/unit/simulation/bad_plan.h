#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "core/base/field_violations.h"
#include "core/simulation/plan_check.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {

struct BadPlan {
  std::string name;
  std::function<void(plan::SimulationSpec&)> spoil;
  std::string field;
  std::string description;  ///< part of it: the value or the bound
};

/// Spoils the small plan and expects to be told so, by whoever makes a simulation of it and by
/// whoever only asks.
class PlanIsRefused : public testing::TestWithParam<BadPlan> {};

inline void expect_refused(const BadPlan& bad) {
  using testing::Field;
  plan::SimulationSpec spec = make_small_plan();
  bad.spoil(spec);
  const auto created = Simulation::create(make_small_model(), spec);
  ASSERT_FALSE(created.ok());
  EXPECT_EQ(created.status().code(), absl::StatusCode::kInvalidArgument);
  const auto is_told =
      testing::Contains(testing::AllOf(Field(&FieldViolation::field, bad.field),
                                       Field(&FieldViolation::description, testing::HasSubstr(bad.description))));
  EXPECT_THAT(field_violations_of(created.status()), is_told) << created.status();
  const auto check = check_plan_on_model(*make_small_model(), spec, nullptr);
  ASSERT_TRUE(check.ok()) << check.status();
  EXPECT_THAT(check->violations, is_told);
}

}  // namespace lipofill::simulation
