#include "tests/bench/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

namespace lipofill::bench {
namespace {

constexpr double kMillisecondsPerSecond = 1e3;

Span now() {
  timespec cpu = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &cpu);
  const auto wall = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration<double>(wall).count(),
          static_cast<double>(cpu.tv_sec) + 1e-9 * static_cast<double>(cpu.tv_nsec)};
}

double mean_ms(const std::vector<Span>& spans, double Span::*clock) {
  double sum = 0.0;
  for (const Span& span : spans) sum += span.*clock;
  return spans.empty() ? 0.0 : kMillisecondsPerSecond * sum / static_cast<double>(spans.size());
}

double quantile_ms(const std::vector<Span>& spans, double Span::*clock, double q) {
  if (spans.empty()) return 0.0;
  std::vector<double> values;
  for (const Span& span : spans) values.push_back(span.*clock);
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<size_t>(std::ceil(q * static_cast<double>(values.size())));
  return kMillisecondsPerSecond * values[std::max<size_t>(rank, 1) - 1];
}

}  // namespace

Span operator+(const Span& a, const Span& b) {
  return {a.wall_s + b.wall_s, a.cpu_s + b.cpu_s};
}
Span operator*(double factor, const Span& span) {
  return {factor * span.wall_s, factor * span.cpu_s};
}

Stopwatch::Stopwatch() : last_(now()) {}

Span Stopwatch::lap() {
  const Span end = now();
  const Span span = end + (-1.0) * last_;
  last_ = end;
  return span;
}

double Samples::mean_cpu_ms() const {
  return mean_ms(spans_, &Span::cpu_s);
}
double Samples::quantile_cpu_ms(double q) const {
  return quantile_ms(spans_, &Span::cpu_s, q);
}
double Samples::mean_wall_ms() const {
  return mean_ms(spans_, &Span::wall_s);
}
double Samples::quantile_wall_ms(double q) const {
  return quantile_ms(spans_, &Span::wall_s, q);
}

nlohmann::ordered_json Samples::to_json() const {
  nlohmann::ordered_json json = {{"samples", spans_.size()},
                                 {"median_ms", median_cpu_ms()},
                                 {"mean_ms", mean_cpu_ms()},
                                 {"p99_ms", quantile_cpu_ms(0.99)},
                                 {"worst_ms", quantile_cpu_ms(1.0)}};
  if (mean_wall_ms() == 0.0) return json;
  json["wall_median_ms"] = quantile_wall_ms(0.5);
  json["wall_mean_ms"] = mean_wall_ms();
  json["wall_p99_ms"] = quantile_wall_ms(0.99);
  json["wall_worst_ms"] = quantile_wall_ms(1.0);
  return json;
}

void PhaseSamples::add(const std::string& phase, const Span& span) {
  const auto place =
      std::find_if(phases_.begin(), phases_.end(), [&phase](const auto& entry) { return entry.first == phase; });
  if (place != phases_.end()) {
    place->second.add(span);
    return;
  }
  phases_.push_back({phase, {}});
  phases_.back().second.add(span);
}

const Samples* PhaseSamples::find(const std::string& phase) const {
  for (const auto& [name, samples] : phases_) {
    if (name == phase) return &samples;
  }
  return nullptr;
}

nlohmann::ordered_json PhaseSamples::to_json() const {
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  for (const auto& [name, samples] : phases_) object[name] = samples.to_json();
  return object;
}

}  // namespace lipofill::bench
