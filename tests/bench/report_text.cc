// The tables of bench.json for a terminal.

#include <iomanip>

#include "tests/bench/report.h"

namespace lipofill::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kNameWidth = 26;
constexpr int kFigureWidth = 12;

/// Four digits, or a dash for what was not measured.
void put(std::ostream& out, const Json& figure) {
  out << std::setw(kFigureWidth);
  if (figure.is_number()) {
    out << figure.get<double>();
  } else {
    out << "-";
  }
}

void put_samples(std::ostream& out, const std::string& name, const Json& samples) {
  out << "  " << std::left << std::setw(kNameWidth) << name << std::right;
  for (const char* figure : {"median_ms", "mean_ms", "p99_ms", "worst_ms"}) put(out, samples.at(figure));
  out << "\n";
}

void print_steps(const Json& scale, std::ostream& out) {
  out << "\n"
      << scale.at("scale") << "x: " << scale.at("hexahedra") << " hexahedra, " << scale.at("unknowns") << " unknowns, "
      << scale.at("film_cells") << " film cells\n"
      << "  " << std::left << std::setw(kNameWidth) << "a step [ms]" << std::right;
  for (const char* title : {"median", "mean", "p99", "worst"}) out << std::setw(kFigureWidth) << title;
  out << "\n";
  const Json& steps = scale.at("steps");
  put_samples(out, "step", steps.at("phases").at("step"));
  for (const auto& [part, samples] : steps.at("parts").at("times").items()) put_samples(out, "  " + part, samples);
  for (const auto& [phase, samples] : steps.at("phases").items()) {
    if (phase != "step") put_samples(out, phase, samples);
  }
  out << "  a step has";
  for (const auto& [what, count] : steps.at("parts").at("per_step").items()) {
    out << "  " << what << " " << count.get<double>();
  }
  out << "\n";
}

void print_routes(const Json& scale, std::ostream& out) {
  if (scale.at("routes").empty()) return;
  out << "  " << std::left << std::setw(kNameWidth) << "one linear step [ms]" << std::right;
  for (const char* title : {"median", "factor", "analysis", "iterations", "difference"}) {
    out << std::setw(kFigureWidth) << title;
  }
  out << "\n";
  for (const Json& route : scale.at("routes")) {
    out << "  " << std::left << std::setw(kNameWidth) << route.at("name").get<std::string>() << std::right;
    if (route.at("total").is_null()) {
      out << std::setw(kFigureWidth) << "-"
          << "\n";
      continue;
    }
    put(out, route.at("total").at("median_ms"));
    put(out, route.at("phases").at("factor").at("median_ms"));
    put(out, route.at("analysis_ms"));
    put(out, route.at("iterations"));
    put(out, route.at("relative_difference"));
    out << (route.at("is_complete") ? "" : "  (from a sample)") << "\n";
  }
  out << "  floor";
  put(out, scale.at("floor_ms"));
  out << " ms, the paper's way";
  put(out, scale.at("paper_way_step_ms"));
  out << " ms\n";
}

void print_equilibria(const Json& report, std::ostream& out) {
  out << "\nthe settled shape directly; F: assembly, float32 factor and solve\n"
      << "  " << std::left << std::setw(kNameWidth) << "in F" << std::right;
  for (const Json& at : report.at("equilibria")) {
    out << std::setw(kFigureWidth - 1) << at.at("scale") << "x";
  }
  out << "\n";
  for (const char* key : {"unit_ms", "cold_f", "cold_factors", "cold_iterations", "drag_f", "drag_updates_per_s",
                          "sensitivity_f", "thicker_tissue_f", "ensemble_member_f", "ensemble_batch_f", "error_mm"}) {
    out << "  " << std::left << std::setw(kNameWidth) << key << std::right;
    for (const Json& at : report.at("equilibria")) put(out, at.at(key));
    out << "\n";
  }
}

void print_bounds(const Json& report, std::ostream& out) {
  out << "\n"
      << std::left << std::setw(kNameWidth + 18) << "design, section 6" << std::right << std::setw(kFigureWidth)
      << "measured" << std::setw(kFigureWidth) << "bound"
      << "\n";
  for (const Json& row : report.at("bounds")) {
    out << std::left << std::setw(kNameWidth + 18) << row.at("name").get<std::string>() << std::right;
    put(out, report.at(row.at("key").get<std::string>()));
    out << (row.at("at_most").get<bool>() ? "  <=" : "  >=");
    put(out, row.at("bound"));
    out << (row.at("met").is_null() ? "  not measured" : row.at("met").get<bool>() ? "  met" : "  NOT MET") << "\n";
  }
}

}  // namespace

void print_report(const Json& report, std::ostream& out) {
  out << std::setprecision(4);
  for (const Json& scale : report.at("scales")) {
    print_steps(scale, out);
    print_routes(scale, out);
  }
  out << "\nsettled after " << report.at("settle_wall_s").get<double>() << " s of wall time, "
      << report.at("settled").at("as_planned").at("steps") << " steps; state "
      << report.at("state_hash").get<std::string>() << "\n";
  print_equilibria(report, out);
  print_bounds(report, out);
}

}  // namespace lipofill::bench
