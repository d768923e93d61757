#include "core/anatomy/zone_edges.h"

#include "core/anatomy/sided_names.h"
#include "core/base/units.h"

namespace lipofill::anatomy {
namespace {

struct EdgeRow {
  const char* region;
  double stiffness_kpa_per_mm;
  double width_mm;
  bool feathers;
};

constexpr EdgeRow kRows[] = {
    {"masseter", 25.0, 4.0, false},          // the fascia over the parotid gland and the muscle
    {"mandibular_angle", 25.0, 4.0, false},  // the septum along the rim of the mandible
    {"buccal", 8.0, 6.0, true},              // loose fat
    {"malar", 25.0, 4.0, false},             // zygomatic and orbicularis retaining ligaments
    {"temple", 25.0, 4.0, false},            // the temporal septa
    {"tear_trough", 25.0, 3.0, false},       // the tear trough ligament
    {"nasolabial", 20.0, 4.0, false},        // the fascia of the fold
    {"chin", 20.0, 4.0, false},              // the mandibular ligament
};
constexpr EdgeRow kOther = {"", 20.0, 4.0, false};

}  // namespace

ZoneEdge edge_of_region(std::string_view name) {
  EdgeRow found = kOther;
  if (const auto parts = split_side(name)) {
    for (const EdgeRow& row : kRows) {
      if (parts->first == row.region) found = row;
    }
  }
  return {found.stiffness_kpa_per_mm * kPascalsPerMetrePerKilopascalPerMillimetre,
          found.width_mm * kMetresPerMillimetre, found.feathers};
}

}  // namespace lipofill::anatomy
