// Figures under their names in the schema, all of them.

#include "client/cpp/message_figures.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace lipofill::client {
namespace {

std::vector<std::string> names_of(const google::protobuf::Descriptor& type) {
  std::vector<std::string> names;
  for (int i = 0; i < type.field_count(); ++i) names.emplace_back(type.field(i)->name());
  return names;
}

TEST(FiguresOf, HasEveryFieldOfTheSchemaInItsOrder) {
  const auto figures = figures_of(v1::Summary());
  std::vector<std::string> keys;
  for (const auto& [key, value] : figures.items()) keys.push_back(key);
  EXPECT_EQ(keys, names_of(*v1::Summary::descriptor()));
}

TEST(FiguresOf, KeepsNumbersNamesAndWhatIsAbsent) {
  v1::Summary summary;
  summary.set_steps(std::numeric_limits<uint64_t>::max());
  summary.set_max_pressure_pa(1.0 / 3.0);
  summary.mutable_preview()->set_state(v1::PreviewSummary::DONE);
  summary.add_zones()->set_name("middle");
  const auto figures = figures_of(summary);
  EXPECT_EQ(figures["steps"], std::numeric_limits<uint64_t>::max()) << "a number, not the string of proto3's JSON";
  EXPECT_EQ(figures["max_pressure_pa"], 1.0 / 3.0);
  EXPECT_EQ(figures["preview"]["state"], "DONE");
  EXPECT_TRUE(figures["preview"]["difference_max_mm"].is_null());
  EXPECT_TRUE(figures["settling_error_mm"].is_null());
  EXPECT_TRUE(figures["cost"].is_null());
  EXPECT_EQ(figures["zones"][0]["name"], "middle");
  EXPECT_EQ(figures["ligaments"], nlohmann::ordered_json::array());
}

TEST(ColumnsOfSeries, HaveEveryFigureOfARowAndOfItsCost) {
  v1::SimulationSpec spec;
  spec.add_probes()->set_name("centre");
  std::vector<std::string> names;
  for (const SeriesColumn& column : columns_of_series(spec)) names.push_back(column.name);
  std::vector<std::string> expected = names_of(*v1::SeriesRow::descriptor());
  std::erase(expected, "cost");
  std::replace(expected.begin(), expected.end(), std::string("probe_thickness_mm"),
               std::string("probe_centre_thickness_mm"));
  std::replace(expected.begin(), expected.end(), std::string("probe_pressure_pa"),
               std::string("probe_centre_pressure_pa"));
  for (const std::string& name : names_of(*v1::ComputingCost::descriptor())) expected.push_back(name);
  EXPECT_THAT(names, ::testing::UnorderedElementsAreArray(expected));
}

}  // namespace
}  // namespace lipofill::client
