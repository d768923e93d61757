#include "tests/verification/forecast/twin_forecast.h"

#include <algorithm>
#include <cmath>

namespace lipofill::verification {
namespace {

using forecast::FigureKind;
using forecast::Spread;

/// Next to the rim nothing moves [m].
constexpr double kLeastLift = 1e-4;

constexpr FigureKind kKinds[] = {FigureKind::kMaxLift, FigureKind::kSkinVolume, FigureKind::kMeanPressure};
constexpr const char* kNames[] = {"largest lift", "volume of the skin", "pressure"};

bool holds(const Spread& spread, double value) {
  return spread.p05 <= value && value <= spread.p95;
}

/// The share of the vertices that move whose lift of a twin is inside.
double share_of_nodes(const forecast::ForecastTime& time, const Twin& twin) {
  int inside = 0, moving = 0;
  for (Eigen::Index node = 0; node < twin.lift_of_node.size(); ++node) {
    if (time.lift_p95[node] < kLeastLift) continue;
    ++moving;
    inside += time.lift_p05[node] <= twin.lift_of_node[node] && twin.lift_of_node[node] <= time.lift_p95[node];
  }
  return static_cast<double>(inside) / moving;
}

}  // namespace

absl::StatusOr<forecast::Forecast> make_twin_forecast(const TwinCase& twin_case, int members) {
  forecast::ForecastRequest request;
  request.plan = twin_case.plan;
  request.members = members;
  request.months = {12.0};
  request.only_named_inputs = true;
  request.session_band = 4000.0;
  request.inputs = twin_case.inputs;
  const auto model = model::build_face_model(twin_case.model, nullptr);
  if (!model.ok()) return model.status();
  return forecast::make_forecast(*model, request, 2, {}, nullptr);
}

const forecast::ForecastFigure& figure_of(const forecast::ForecastTime& time, int k) {
  return *std::find_if(time.figures.begin(), time.figures.end(),
                       [&](const forecast::ForecastFigure& figure) { return figure.kind == kKinds[k]; });
}

std::string figure_name(int k) {
  return kNames[k];
}

Shares find_shares(const forecast::ForecastTime& time, const std::vector<Twin>& twins) {
  Shares shares;
  const double one = 1.0 / static_cast<double>(twins.size());
  for (const Twin& twin : twins) {
    shares.lift += one * holds(figure_of(time, 0).spread, twin.lift);
    shares.volume += one * holds(figure_of(time, 1).spread, twin.volume);
    shares.pressure += one * holds(figure_of(time, 2).spread, twin.pressure);
    shares.node += one * share_of_nodes(time, twin);
  }
  return shares;
}

IndexGap find_gap(const forecast::ForecastFigure& figure, int k, const PickedIndices& picked) {
  IndexGap gap;
  for (Eigen::Index input = 0; input < picked.first.cols(); ++input) {
    const forecast::Influence& influence = figure.influences->of_input[static_cast<size_t>(input)];
    gap.first = std::max(gap.first, std::abs(influence.first_order - picked.first(k, input)));
    gap.total = std::max(gap.total, std::abs(influence.total - picked.total(k, input)));
    gap.error = std::max({gap.error, picked.first_error(k, input), picked.total_error(k, input)});
  }
  return gap;
}

}  // namespace lipofill::verification
