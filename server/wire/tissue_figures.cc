#include "server/wire/tissue_figures.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/units.h"

namespace lipofill::server {
namespace {

using anatomy::TissueKind;

std::optional<anatomy::TissuePreset> preset_of(const v1::ModelSpec& spec) {
  switch (spec.tissue_preset()) {
    case v1::PAPER:
      return anatomy::TissuePreset::kPaper;
    case v1::ELASTOGRAPHY:
      return anatomy::TissuePreset::kElastography;
    default:
      return std::nullopt;
  }
}

v1::TissueLayer::Law law_of(anatomy::TissuePreset preset) {
  return preset == anatomy::TissuePreset::kElastography ? v1::TissueLayer::NEO_HOOKEAN : v1::TissueLayer::COROTATIONAL;
}

void fill(const anatomy::TissueFigures& figures, v1::TissueLayer& layer) {
  if (!layer.has_thickness_mm() && !layer.has_down_to_bone()) {
    layer.mutable_thickness_mm()->set_constant(figures.thickness / kMetresPerMillimetre);
  }
  if (!layer.has_youngs_modulus_kpa()) layer.set_youngs_modulus_kpa(figures.youngs_modulus / kPascalsPerKilopascal);
  if (!layer.has_poisson_ratio()) layer.set_poisson_ratio(figures.poisson_ratio);
  if (!layer.has_density_kg_m3()) layer.set_density_kg_m3(figures.density);
}

}  // namespace

std::optional<TissueKind> kind_of(const v1::TissueLayer& layer) {
  switch (layer.kind()) {
    case v1::TissueLayer::SKIN:
      return TissueKind::kSkin;
    case v1::TissueLayer::SUBCUTANEOUS:
      return TissueKind::kSubcutaneous;
    case v1::TissueLayer::SMAS:
      return TissueKind::kSmas;
    case v1::TissueLayer::MUSCLE:
      return TissueKind::kMuscle;
    default:
      return anatomy::find_tissue_kind(layer.name());
  }
}

v1::ModelSpec fill_tissue_figures(v1::ModelSpec spec) {
  const auto preset = preset_of(spec);
  if (!preset) return spec;
  for (v1::TissueLayer& layer : *spec.mutable_layers()) {
    if (layer.law() == v1::TissueLayer::LAW_UNSPECIFIED) layer.set_law(law_of(*preset));
    if (const auto kind = kind_of(layer)) fill(anatomy::figures_of(*preset, *kind), layer);
  }
  if (*preset == anatomy::TissuePreset::kElastography && spec.has_scan_region() &&
      spec.base().kind() == v1::Support::KIND_UNSPECIFIED) {
    spec.mutable_base()->set_kind(v1::Support::BY_REGION);
  }
  return spec;
}

std::string describe_missing_figure(const v1::ModelSpec& spec, const v1::TissueLayer& layer) {
  if (!preset_of(spec)) return "is missing";
  return absl::StrCat("is missing, and neither kind nor the name '", layer.name(), "' is one that the preset ",
                      v1::TissuePreset_Name(spec.tissue_preset()),
                      " knows: ", absl::StrJoin(anatomy::tissue_kind_names(), ", "));
}

}  // namespace lipofill::server
