#pragma once

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

namespace lipofill::server {

/// Boundaries from a tenth of a millisecond to ten seconds, for steps of small squares and of large
/// faces.
inline const prometheus::Histogram::BucketBoundaries kSecondsBoundaries = {
    0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 10.0};

inline prometheus::Family<prometheus::Counter>& add_counters(prometheus::Registry& registry, const char* name,
                                                             const char* help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

inline prometheus::Counter& add_counter(prometheus::Registry& registry, const char* name, const char* help) {
  return add_counters(registry, name, help).Add({});
}

inline prometheus::Family<prometheus::Gauge>& add_gauges(prometheus::Registry& registry, const char* name,
                                                         const char* help) {
  return prometheus::BuildGauge().Name(name).Help(help).Register(registry);
}

inline prometheus::Family<prometheus::Histogram>& add_histograms(prometheus::Registry& registry, const char* name,
                                                                 const char* help) {
  return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
}

}  // namespace lipofill::server
