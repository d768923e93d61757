#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace lipofill::bench {

/// A span of time. Ratios come from the processor time of this thread: what else a machine does
/// leaves that alone.
struct Span {
  double wall_s = 0.0;
  double cpu_s = 0.0;
};
Span operator+(const Span& a, const Span& b);
Span operator*(double factor, const Span& span);

/// Runs from when it is made, and again from each lap.
class Stopwatch {
 public:
  Stopwatch();
  Span lap();

 private:
  Span last_;
};

/// Spans of one thing done again and again.
class Samples {
 public:
  void add(const Span& span) { spans_.push_back(span); }
  bool empty() const { return spans_.empty(); }
  size_t size() const { return spans_.size(); }
  const std::vector<Span>& spans() const { return spans_; }

  double mean_cpu_ms() const;
  double median_cpu_ms() const { return quantile_cpu_ms(0.5); }
  /// The least sample that a share `q` of all does not exceed.
  double quantile_cpu_ms(double q) const;
  double mean_wall_ms() const;
  double quantile_wall_ms(double q) const;

  /// {"samples", "median_ms", "mean_ms", "p99_ms", "worst_ms", and where wall time was taken too
  /// "wall_median_ms", ...}
  nlohmann::ordered_json to_json() const;

 private:
  std::vector<Span> spans_;
};

/// Samples by the name of a phase, in the order in which the names first came.
class PhaseSamples {
 public:
  void add(const std::string& phase, const Span& span);
  const Samples* find(const std::string& phase) const;
  const std::vector<std::pair<std::string, Samples>>& phases() const { return phases_; }

  nlohmann::ordered_json to_json() const;

 private:
  std::vector<std::pair<std::string, Samples>> phases_;
};

}  // namespace lipofill::bench
