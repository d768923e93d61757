#include "server/wire/field_mask.h"

#include <gtest/gtest.h>

#include "core/base/field_violations.h"
#include "lipofill/v1/simulation.pb.h"

namespace lipofill::server {
namespace {

google::protobuf::FieldMask mask_of(const std::vector<std::string>& paths) {
  google::protobuf::FieldMask mask;
  for (const std::string& path : paths) mask.add_paths(path);
  return mask;
}

v1::Simulation example() {
  v1::Simulation simulation;
  simulation.set_name("simulations/x");
  simulation.set_state(v1::Simulation::PAUSED);
  simulation.mutable_summary()->set_steps(7);
  simulation.mutable_summary()->set_time_s(0.07);
  return simulation;
}

TEST(FieldMask, KeepsWhatItNames) {
  v1::Simulation simulation = example();
  apply_field_mask(mask_of({"state", "summary.steps"}), simulation);
  EXPECT_EQ(simulation.ShortDebugString(), "state: PAUSED summary { steps: 7 }");
}

TEST(FieldMask, KeepsEverythingWhenItIsEmptyOrAStar) {
  for (const auto& mask : {mask_of({}), mask_of({"*"})}) {
    EXPECT_TRUE(check_field_mask(mask, *v1::Simulation::descriptor(), "read_mask").ok());
    v1::Simulation simulation = example();
    apply_field_mask(mask, simulation);
    EXPECT_EQ(simulation.DebugString(), example().DebugString());
    EXPECT_TRUE(is_masked(mask, "state"));
  }
  EXPECT_FALSE(is_masked(mask_of({"name"}), "state"));
}

TEST(FieldMask, NamesPathsThatAreNoFields) {
  const auto mask = mask_of({"state", "summary.colour", "", "summary..steps", "spec.films.name"});
  const auto violations = field_violations_of(check_field_mask(mask, *v1::Simulation::descriptor(), "read_mask"));
  ASSERT_EQ(violations.size(), 4u);
  EXPECT_EQ(violations[0].field, "read_mask.paths[1]");
  EXPECT_EQ(violations[0].description, "is \"summary.colour\", which is no field of Simulation");
}

TEST(FieldMask, IsBoundedInLength) {
  const std::vector<std::string> many(201, "name");
  EXPECT_FALSE(check_field_mask(mask_of(many), *v1::Simulation::descriptor(), "read_mask").ok());
}

}  // namespace
}  // namespace lipofill::server
