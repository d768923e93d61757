#include "core/forecast/figures.h"

#include <algorithm>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace lipofill::forecast {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using simulation::MemberShape;

/// Upper ends of the bands [Pa]: 9, 15 and 30 mmHg (reference: critical interstitial pressure,
/// Khouri 2014; the others assumed).
constexpr double kPascalsPerMmhg = 133.322;
constexpr double kBandEnds[] = {9.0 * kPascalsPerMmhg, 15.0 * kPascalsPerMmhg, 30.0 * kPascalsPerMmhg};
/// Causes that are told: so many, and none below this share of the variance.
constexpr size_t kMostCauses = 3;
constexpr double kLeastCause = 0.05;

double value_of(const MemberShape& shape, FigureKind kind, Index zone) {
  switch (kind) {
    case FigureKind::kMaxLift:
      return shape.max_lift;
    case FigureKind::kSkinVolume:
      return shape.skin_volume;
    case FigureKind::kMeanPressure:
      return shape.pressure[zone];
    case FigureKind::kVolume:
      break;
  }
  return shape.volume[zone];
}

VectorXd values_of(const MemberTable& table, size_t time, FigureKind kind, Index zone) {
  VectorXd values(static_cast<Index>(table.shapes.size()));
  for (size_t k = 0; k < table.shapes.size(); ++k) {
    values[static_cast<Index>(k)] = value_of(table.shapes[k][time], kind, zone);
  }
  return values;
}

PressureBands find_bands(const std::string& zone, const VectorXd& pressure) {
  PressureBands bands{zone, Eigen::Vector4d::Zero()};
  for (const double value : pressure) {
    const auto band =
        std::count_if(std::begin(kBandEnds), std::end(kBandEnds), [&](double end) { return value >= end; });
    bands.probability[band] += 1.0;
  }
  bands.probability /= static_cast<double>(pressure.size());
  return bands;
}

Index zone_index(const std::vector<std::string>& zones, const std::string& name) {
  return std::find(zones.begin(), zones.end(), name) - zones.begin();
}

}  // namespace

ForecastTime summarise_time(const MemberTable& table, size_t time, double month, const std::vector<std::string>& zones,
                            const MemberShape& nominal, bool fields) {
  ForecastTime summary;
  summary.month = month;
  const auto add = [&](FigureKind kind, const std::string& zone, Index index) {
    const VectorXd values = values_of(table, time, kind, index);
    summary.figures.push_back({kind, zone, value_of(nominal, kind, index), summarise(values), {}});
    if (kind == FigureKind::kMeanPressure) summary.bands.push_back(find_bands(zone, values));
  };
  add(FigureKind::kMaxLift, "", 0);
  add(FigureKind::kSkinVolume, "", 0);
  for (size_t z = 0; z < zones.size(); ++z) {
    add(FigureKind::kMeanPressure, zones[z], static_cast<Index>(z));
    add(FigureKind::kVolume, zones[z], static_cast<Index>(z));
  }
  if (!fields) return summary;
  summary.mean_displacement = table.skin_sum[time] / static_cast<double>(table.settled.size());
  const Eigen::MatrixXf& lift = table.lift[time];
  summary.lift_p05.resize(lift.cols());
  summary.lift_p95.resize(lift.cols());
  for (Index node = 0; node < lift.cols(); ++node) {
    Eigen::VectorXf of_node = lift.col(node);
    summary.lift_p05[node] = quantile_of(of_node, 0.05f);
    summary.lift_p95[node] = quantile_of(of_node, 0.95f);
  }
  return summary;
}

void add_influences(const MemberTable& table, size_t time, const Design& design, const std::vector<std::string>& zones,
                    ForecastTime& to) {
  Eigen::MatrixXd standard(static_cast<Index>(table.settled.size()), design.standard.cols());
  for (size_t k = 0; k < table.settled.size(); ++k) {
    standard.row(static_cast<Index>(k)) = design.standard.row(table.settled[k]);
  }
  for (ForecastFigure& figure : to.figures) {
    const VectorXd values = values_of(table, time, figure.kind, zone_index(zones, figure.zone));
    figure.influences = find_influences(standard, design.is_gaussian, values);
  }
}

std::string describe_figure(const ForecastFigure& figure) {
  switch (figure.kind) {
    case FigureKind::kMaxLift:
      return "the largest lift of the skin";
    case FigureKind::kSkinVolume:
      return "the volume that the skin gains";
    case FigureKind::kMeanPressure:
      return "the pressure in " + figure.zone;
    case FigureKind::kVolume:
      break;
  }
  return "the fat in " + figure.zone;
}

std::vector<std::string> describe_causes(const ForecastTime& time, const std::vector<UncertainInput>& inputs) {
  const std::string when = time.month == 0.0 ? "at once" : absl::StrFormat("after %.3g months", time.month);
  std::vector<std::string> sentences;
  for (const ForecastFigure& figure : time.figures) {
    if (!figure.influences || figure.kind == FigureKind::kVolume) continue;
    if (figure.influences->unexplained > kMostUnexplained) {
      sentences.push_back(
          absl::StrFormat("What causes the spread of %s %s is not told: polynomials leave %.0f %% of it "
                          "unexplained.",
                          describe_figure(figure), when, 100.0 * figure.influences->unexplained));
      continue;
    }
    std::vector<size_t> order(inputs.size());
    std::iota(order.begin(), order.end(), 0);
    const auto total = [&](size_t k) { return figure.influences->of_input[k].total; };
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return total(a) > total(b); });
    std::vector<std::string> parts;
    for (const size_t k : order) {
      if (parts.size() == kMostCauses || total(k) < kLeastCause) break;
      parts.push_back(absl::StrFormat("%s (%.0f +- %.0f %%)", inputs[k].describe(), 100.0 * total(k),
                                      100.0 * figure.influences->of_input[k].total_error));
    }
    if (parts.empty()) continue;
    sentences.push_back(absl::StrCat("The spread of ", describe_figure(figure), " ", when, " comes mostly from ",
                                     absl::StrJoin(parts, ", "), "."));
  }
  return sentences;
}

}  // namespace lipofill::forecast
