#include "core/forecast/uncertain_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/anatomy/tissue_presets.h"
#include "core/base/units.h"

namespace lipofill::forecast {
namespace {

using anatomy::TissueKind;

/// Spreads of a kind of tissue, with where they come from.
struct KindSpread {
  TissueKind kind;
  double modulus;
  const char* modulus_source;
  double thickness;
  const char* thickness_source;
  bool is_thickness_assumed;
};

/// A range counts as four standard deviations of the logarithm.
double spread_of_range(double low, double high) {
  return std::log(high / low) / 4.0;
}

const std::array<KindSpread, 4>& spreads() {
  static const std::array<KindSpread, 4> all = {{
      {TissueKind::kSkin, spread_of_range(90.0, 500.0),
       "range 90-500 kPa of the source paper as four standard deviations", spread_of_range(1.5, 2.0),
       "range 1.5-2.0 mm (Clin Anat 2019, pubmed 30882511) as four standard deviations", false},
      {TissueKind::kSubcutaneous, spread_of_range(1.0, 20.0), "range 1-20 kPa (JMBBM 2023) as four standard deviations",
       spread_of_range(1.6, 5.1), "range 1.6-5.1 mm (Clin Anat 2019, pubmed 30882511) as four standard deviations",
       false},
      {TissueKind::kSmas, spread_of_range(20.0, 200.0),
       "range 20-200 kPa (Har-Shai 1996/97) as four standard deviations", 0.2, "assumed: no range was found", true},
      {TissueKind::kMuscle, spread_of_range(10.0, 500.0),
       "range 10-500 kPa (elastography and the source paper) as four standard deviations", spread_of_range(8.7, 15.0),
       "range 8.7-15 mm (Kiliaridis 1991) as four standard deviations", false},
  }};
  return all;
}

const KindSpread& spread_of(const model::TissueLayerSpec& layer) {
  const TissueKind kind = layer.kind.value_or(anatomy::find_tissue_kind(layer.name).value_or(TissueKind::kMuscle));
  return *std::find_if(spreads().begin(), spreads().end(), [&](const KindSpread& row) { return row.kind == kind; });
}

/// A surgeon reads the syringe to a twentieth.
constexpr double kVolumeSpread = 0.05;
/// Landmarks that are placed by hand lie off by this, each way [m].
constexpr double kPlaceSpread = 1.5e-3;

/// These bounds say what is possible: soft tissue has 0.1 kPa to 10 MPa; a layer thinner than a
/// third or thicker than three times of what was measured is another layer.
constexpr double kLeastModulus = 100.0;
constexpr double kMostModulus = 1e7;
constexpr double kLeastThickness = 1.0 / 3.0;
constexpr double kMostThickness = 3.0;
constexpr double kMostVolume = 3.0;
constexpr double kMostPlace = 10e-3;

const model::TissueLayerSpec* find_layer(const std::vector<model::TissueLayerSpec>& layers, const std::string& name) {
  const auto found = std::find_if(layers.begin(), layers.end(),
                                  [&](const model::TissueLayerSpec& layer) { return layer.name == name; });
  return found == layers.end() ? nullptr : &*found;
}

std::vector<std::string> filled_zones(const plan::SimulationSpec& plan) {
  std::vector<std::string> zones;
  for (const plan::InjectionSpec& injection : plan.injections) {
    if (std::find(zones.begin(), zones.end(), injection.zone) == zones.end()) zones.push_back(injection.zone);
  }
  return zones;
}

/// Cuts a distribution of multiples of E off where the tissue ends to be tissue.
Distribution within_tissue(Distribution d, double modulus) {
  d.low = std::max(d.low, kLeastModulus / modulus);
  d.high = std::min(d.high, kMostModulus / modulus);
  return d;
}

Distribution within(Distribution d, double least, double most) {
  d.low = std::max(d.low, least);
  d.high = std::min(d.high, most);
  return d;
}

/// As requests have it.
Distribution in_millimetres(Distribution d) {
  for (double* value : {&d.centre, &d.spread, &d.low, &d.high}) *value *= kMillimetresPerMetre;
  return d;
}

void check_layer_input(const std::string& field, const std::vector<model::TissueLayerSpec>& layers,
                       const UncertainInput& input, FieldViolations& violations) {
  const model::TissueLayerSpec* layer = find_layer(layers, input.name);
  if (layer == nullptr) {
    violations.add(field + ".name", absl::StrCat("is '", input.name, "', the model has no layer of that name"));
    return;
  }
  const std::string distribution = field + ".distribution";
  if (input.quantity == Quantity::kLayerThickness) {
    check_distribution(distribution, input.distribution, kLeastThickness, kMostThickness, "times the thickness",
                       violations);
    return;
  }
  const double modulus = layer->material.youngs_modulus;
  check_distribution(distribution, input.distribution, kLeastModulus / modulus, kMostModulus / modulus,
                     absl::StrCat("times ", modulus / kPascalsPerKilopascal, " kPa"), violations);
}

void check_input(const std::string& field, const std::vector<model::TissueLayerSpec>& layers,
                 const plan::SimulationSpec& plan, const UncertainInput& input, FieldViolations& violations) {
  const std::string distribution = field + ".distribution";
  switch (input.quantity) {
    case Quantity::kLayerModulus:
    case Quantity::kLayerThickness:
      check_layer_input(field, layers, input, violations);
      return;
    case Quantity::kZoneVolume: {
      const auto zones = filled_zones(plan);
      if (std::find(zones.begin(), zones.end(), input.name) == zones.end()) {
        violations.add(field + ".name",
                       absl::StrCat("is '", input.name, "', the plan has no injection into a zone of that name"));
      }
      check_distribution(distribution, input.distribution, 0.0, kMostVolume, "times the volume", violations);
      return;
    }
    case Quantity::kPlaceXi:
    case Quantity::kPlaceEta:
      if (!input.name.empty()) violations.add(field + ".name", "must be empty: all zones move together");
      check_distribution(distribution, in_millimetres(input.distribution), -kMostPlace * kMillimetresPerMetre,
                         kMostPlace * kMillimetresPerMetre, "mm", violations);
      return;
    case Quantity::kRetention:
      violations.add(field + ".quantity", "must not be RETENTION, which the field retention sets");
      return;
  }
}

}  // namespace

std::string UncertainInput::describe() const {
  switch (quantity) {
    case Quantity::kLayerModulus:
      return "the stiffness of the layer " + name;
    case Quantity::kLayerThickness:
      return "the thickness of the layer " + name;
    case Quantity::kZoneVolume:
      return "the volume delivered into " + name;
    case Quantity::kPlaceXi:
      return "the place of the zones along xi";
    case Quantity::kPlaceEta:
      return "the place of the zones along eta";
    case Quantity::kRetention:
      break;
  }
  return "the retention of fat";
}

std::vector<UncertainInput> default_inputs(const std::vector<model::TissueLayerSpec>& layers,
                                           const plan::SimulationSpec& plan) {
  std::vector<UncertainInput> inputs;
  for (const model::TissueLayerSpec& layer : layers) {
    const KindSpread& spread = spread_of(layer);
    inputs.push_back({Quantity::kLayerModulus, layer.name,
                      within_tissue(Distribution::log_normal(1.0, spread.modulus), layer.material.youngs_modulus),
                      spread.modulus_source, false});
  }
  for (const model::TissueLayerSpec& layer : layers) {
    const KindSpread& spread = spread_of(layer);
    inputs.push_back({Quantity::kLayerThickness, layer.name,
                      within(Distribution::log_normal(1.0, spread.thickness), kLeastThickness, kMostThickness),
                      spread.thickness_source, spread.is_thickness_assumed});
  }
  for (const std::string& zone : filled_zones(plan)) {
    inputs.push_back({Quantity::kZoneVolume, zone, Distribution::normal(1.0, kVolumeSpread),
                      "assumed: a syringe is read to a twentieth", true});
  }
  for (const Quantity place : {Quantity::kPlaceXi, Quantity::kPlaceEta}) {
    inputs.push_back({place, "", Distribution::normal(0.0, kPlaceSpread),
                      "assumed: landmarks placed by hand lie off by 1.5 mm each way", true});
  }
  return inputs;
}

absl::StatusOr<std::vector<UncertainInput>> choose_inputs(const std::vector<model::TissueLayerSpec>& layers,
                                                          const plan::SimulationSpec& plan,
                                                          const std::vector<UncertainInput>& given, bool only_given) {
  FieldViolations violations;
  std::vector<UncertainInput> inputs;
  if (!only_given) inputs = default_inputs(layers, plan);
  std::vector<UncertainInput> seen;
  for (size_t k = 0; k < given.size(); ++k) {
    const std::string field = absl::StrCat("inputs[", k, "]");
    const auto is_same = [&](const UncertainInput& other) { return other.is_same(given[k]); };
    if (std::any_of(seen.begin(), seen.end(), is_same)) {
      violations.add(field, absl::StrCat("is about ", given[k].describe(), " again"));
    }
    seen.push_back(given[k]);
    check_input(field, layers, plan, given[k], violations);
    const auto known = std::find_if(inputs.begin(), inputs.end(), is_same);
    if (known == inputs.end()) {
      inputs.push_back(given[k]);
    } else {
      *known = given[k];
    }
  }
  if (!violations.empty()) return violations.to_status();
  return inputs;
}

}  // namespace lipofill::forecast
