#include "core/anatomy/tissue_presets.h"

#include <array>

namespace lipofill::anatomy {
namespace {

struct TissueRow {
  TissueKind kind;
  const char* name;
  double thickness_mm;
  double elastography_kpa;
  double paper_kpa;
  double poisson_ratio;
  double density;
};

constexpr std::array<TissueRow, 4> kRows = {{
    {TissueKind::kSkin, "skin", 1.8, 100.0, 90.0, 0.48, 1100.0},
    {TissueKind::kSubcutaneous, "subcutaneous", 3.0, 3.0, 90.0, 0.49, 950.0},
    {TissueKind::kSmas, "smas", 1.0, 50.0, 90.0, 0.45, 1050.0},
    {TissueKind::kMuscle, "muscle", 10.0, 20.0, 500.0, 0.49, 1050.0},
}};

const TissueRow& row_of(TissueKind kind) {
  return kRows[static_cast<size_t>(kind)];
}

}  // namespace

TissueFigures figures_of(TissuePreset preset, TissueKind kind) {
  const TissueRow& row = row_of(kind);
  const double kilopascals = preset == TissuePreset::kPaper ? row.paper_kpa : row.elastography_kpa;
  return {row.thickness_mm * 1e-3, kilopascals * 1e3, row.poisson_ratio, row.density};
}

std::vector<std::string> tissue_kind_names() {
  std::vector<std::string> names;
  for (const TissueRow& row : kRows) names.emplace_back(row.name);
  return names;
}

std::string_view name_of(TissueKind kind) {
  return row_of(kind).name;
}

std::optional<TissueKind> find_tissue_kind(std::string_view name) {
  for (const TissueRow& row : kRows) {
    if (name == row.name) return row.kind;
  }
  return std::nullopt;
}

}  // namespace lipofill::anatomy
