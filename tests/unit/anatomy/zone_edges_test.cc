// Figures of the tissue around zones.

#include "core/anatomy/zone_edges.h"

#include <gtest/gtest.h>

#include "core/anatomy/regions.h"

namespace lipofill::anatomy {
namespace {

TEST(ZoneEdges, LooseFatIsSofterAndWiderThanSepta) {
  const ZoneEdge loose = edge_of_region("buccal_left");
  const ZoneEdge firm = edge_of_region("masseter_right");
  EXPECT_LT(loose.stiffness, firm.stiffness);
  EXPECT_GT(loose.width, firm.width);
  EXPECT_DOUBLE_EQ(firm.stiffness, 25e6) << "25 kPa/mm";
  EXPECT_DOUBLE_EQ(firm.width, 4e-3);
  EXPECT_TRUE(loose.feathers);
  EXPECT_FALSE(firm.feathers);
}

TEST(ZoneEdges, EveryNameHasAnEdge) {
  for (const std::string& stem : region_names()) {
    const ZoneEdge edge = edge_of_region(stem + "_left");
    EXPECT_GT(edge.stiffness, 0.0) << stem;
    EXPECT_GT(edge.width, 0.0) << stem;
  }
  EXPECT_GT(edge_of_region("").stiffness, 0.0) << "a disc has no name";
}

}  // namespace
}  // namespace lipofill::anatomy
