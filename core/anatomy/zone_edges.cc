#include "core/anatomy/zone_edges.h"

#include "core/anatomy/sided_names.h"
#include "core/base/units.h"

namespace lipofill::anatomy {
namespace {

struct EdgeRow {
  const char* region;
  double stiffness_kpa_per_mm;
  double width_mm;
};

constexpr EdgeRow kRows[] = {
    {"masseter", 25.0, 4.0},          // the fascia over the parotid gland and the muscle
    {"mandibular_angle", 25.0, 4.0},  // the septum along the rim of the mandible
    {"buccal", 8.0, 6.0},             // loose fat
    {"malar", 25.0, 4.0},             // zygomatic and orbicularis retaining ligaments
    {"temple", 25.0, 4.0},            // the temporal septa
    {"tear_trough", 25.0, 3.0},       // the tear trough ligament
    {"nasolabial", 20.0, 4.0},        // the fascia of the fold
    {"chin", 20.0, 4.0},              // the mandibular ligament
};
constexpr EdgeRow kOther = {"", 20.0, 4.0};

}  // namespace

ZoneEdge edge_of_region(std::string_view name) {
  EdgeRow found = kOther;
  if (const auto parts = split_side(name)) {
    for (const EdgeRow& row : kRows) {
      if (parts->first == row.region) found = row;
    }
  }
  return {found.stiffness_kpa_per_mm * kPascalsPerMetrePerKilopascalPerMillimetre,
          found.width_mm * kMetresPerMillimetre};
}

}  // namespace lipofill::anatomy
