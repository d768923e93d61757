#include "client/cpp/report/record.h"

#include <algorithm>

#include "client/cpp/message_figures.h"
#include "client/cpp/report/record_volumes.h"

namespace lipofill::client {
namespace {

using nlohmann::ordered_json;

ordered_json record_of_scan(const v1::Scan& scan) {
  return {{"sha256", scan.sha256()}, {"vertices", scan.report().vertices()}, {"triangles", scan.report().triangles()}};
}

ordered_json record_of_model(v1::Model model) {
  model.clear_name();
  model.clear_create_time();
  if (model.spec().has_scan_region()) {
    model.mutable_spec()->mutable_scan_region()->clear_scan();
    model.mutable_spec()->mutable_scan_region()->clear_bone_scan();
  }
  return figures_of(model);
}

ordered_json record_of_shape(const ReportedShape& shape) {
  v1::Summary summary = shape.simulation.summary();
  summary.clear_wall_s();
  summary.clear_step_ms_median();
  summary.clear_cost();
  ordered_json record = {{"state", v1::Simulation::State_Name(shape.simulation.state())},
                         {"reason", shape.simulation.reason()},
                         {"summary", figures_of(summary)},
                         {"evaluation", nullptr}};
  for (const char* key : {"wall_s", "step_ms_median", "cost", "preview"}) record["summary"].erase(key);
  if (shape.evaluation) {
    v1::Evaluation evaluation = *shape.evaluation;
    evaluation.clear_distance_mm();
    evaluation.clear_vertices();
    record["evaluation"] = figures_of(evaluation);
  }
  return record;
}

ordered_json record_of_forecast(v1::Forecast forecast) {
  for (v1::ForecastTime& time : *forecast.mutable_times()) {
    time.clear_mean_displacement_mm();
    time.clear_lift_p05_mm();
    time.clear_lift_p95_mm();
  }
  ordered_json record = figures_of(forecast);
  record.erase("wall_s");
  return record;
}

ordered_json record_of_target(const v1::Scan& scan) {
  v1::TargetReport report = scan.report().target();
  report.clear_scan();
  report.clear_surface_scan();
  ordered_json record = record_of_scan(scan);
  record["report"] = figures_of(report);
  return record;
}

ordered_json record_of_deficit(v1::Deficit deficit) {
  deficit.clear_distance_mm();
  return figures_of(deficit);
}

/// Passes of one tunnel follow one another: a line for each tunnel.
ordered_json tunnels_of(const v1::Delivery& delivery) {
  auto tunnels = ordered_json::array();
  for (const v1::CannulaPass& pass : delivery.passes()) {
    const bool goes_on =
        !tunnels.empty() && tunnels.back()["entry"] == pass.entry() && tunnels.back()["tunnel"] == pass.tunnel();
    if (!goes_on) {
      tunnels.push_back({{"entry", pass.entry()},
                         {"tunnel", pass.tunnel()},
                         {"passes", 0},
                         {"volume_ml", 0.0},
                         {"most_in_a_pass_ml", 0.0}});
    }
    ordered_json& tunnel = tunnels.back();
    tunnel["passes"] = tunnel["passes"].get<int>() + 1;
    tunnel["volume_ml"] = tunnel["volume_ml"].get<double>() + pass.volume_ml();
    tunnel["most_in_a_pass_ml"] = std::max(tunnel["most_in_a_pass_ml"].get<double>(), pass.volume_ml());
  }
  return tunnels;
}

ordered_json record_of_delivery(v1::Delivery delivery) {
  delivery.clear_plan_as_given();
  for (v1::CannulaPass& pass : *delivery.mutable_passes()) pass.clear_path_mm();
  ordered_json record = figures_of(delivery);
  record.erase("plan_as_given");
  record["tunnels"] = tunnels_of(delivery);
  return record;
}

template <typename Message, typename Make>
ordered_json record_or_null(const std::optional<Message>& message, const Make& make) {
  return message ? make(*message) : ordered_json(nullptr);
}

}  // namespace

const v1::RetentionAtMonth& last_month_of(const v1::RetentionEstimate& retention) {
  return retention.months(retention.months_size() - 1);
}

ordered_json report_record(const ReportAnswers& answers, const ReportFacts& facts) {
  ordered_json record = {{"notice", "Research and planning aid, not a medical device."},
                         {"date", facts.date},
                         {"pseudonym", facts.pseudonym},
                         {"version", facts.version},
                         {"command", facts.command}};
  record["plan"] = {{"name", answers.plan.name()},
                    {"description", answers.plan.description()},
                    {"sha256", facts.plan_sha256},
                    {"fat", figures_of(answers.plan.simulation().fat())}};
  record["scan"] = record_or_null(answers.scan, record_of_scan);
  record["model"] = record_of_model(answers.model);
  record["retention"] = figures_of(answers.retention);
  record["inputs"] = ordered_json::array();
  for (const v1::UncertainInput& input : answers.inputs) record["inputs"].push_back(figures_of(input));
  record["planned"] = record_of_shape(answers.planned);
  record["remaining"] = record_of_shape(answers.remaining);
  record["remaining"]["month"] = last_month_of(answers.retention).month();
  record["remaining"]["share"] = last_month_of(answers.retention).p50();
  record["forecast"] = record_or_null(answers.forecast, record_of_forecast);
  record["no_forecast"] = answers.no_forecast;
  record["target"] = record_or_null(answers.target, record_of_target);
  record["deficit"] = record_or_null(answers.deficit, record_of_deficit);
  record["delivery"] = record_or_null(answers.delivery, record_of_delivery);
  record["no_delivery"] = answers.no_delivery;
  record["volumes"] = record_of_volumes(answers, facts.reserve_share);
  return record;
}

}  // namespace lipofill::client
