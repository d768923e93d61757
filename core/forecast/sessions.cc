#include "core/forecast/sessions.h"

#include <algorithm>
#include <limits>

namespace lipofill::forecast {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kMostSessions = 8;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Volumes count as reached to this share.
constexpr double kReached = 1e-6;

/// Tells what is left of earlier sessions at a month.
VectorXd present_at(const Retention& retention, const std::vector<Session>& sessions, double month, Index zones) {
  VectorXd present = VectorXd::Zero(zones);
  for (const Session& session : sessions) {
    present += retention.quantile(month - session.month, 0.5) * session.inject;
  }
  return present;
}

/// Sessions at given months; how much is left at the end is for the caller to see.
std::vector<Session> fill(const Retention& retention, const std::vector<ZoneForecast>& zones, int n, double between,
                          double last) {
  const double end = (n - 1) * between + last;
  const auto n_zones = static_cast<Index>(zones.size());
  std::vector<Session> sessions;
  for (int k = 0; k < n; ++k) {
    Session session{k * between, VectorXd::Zero(n_zones), VectorXd::Zero(n_zones)};
    session.present = present_at(retention, sessions, session.month, n_zones);
    const VectorXd left = present_at(retention, sessions, end, n_zones);
    const double kept = retention.quantile(end - session.month, 0.5);
    for (Index z = 0; z < n_zones; ++z) {
      const ZoneForecast& zone = zones[static_cast<size_t>(z)];
      const double room = std::max(0.0, zone.most_at_once - session.present[z]);
      session.inject[z] = std::min(room, std::max(0.0, zone.wanted - left[z]) / kept);
    }
    sessions.push_back(std::move(session));
  }
  return sessions;
}

}  // namespace

double volume_to_inject(const Retention& retention, double month, double wanted, double part) {
  return wanted / retention.quantile(month, 1.0 - part);
}

VectorXd largest_multiples(const VectorXd& multiples, const Eigen::MatrixXd& pressures, const VectorXd& bounds) {
  VectorXd largest = VectorXd::Constant(pressures.rows(), kInfinity);
  for (Index z = 0; z < pressures.rows(); ++z) {
    double multiple_before = 0.0, pressure_before = 0.0;
    for (Index k = 0; k < multiples.size(); ++k) {
      if (pressures(z, k) > bounds[z]) {
        const double part = std::max(0.0, bounds[z] - pressure_before) / (pressures(z, k) - pressure_before);
        largest[z] = multiple_before + part * (multiples[k] - multiple_before);
        break;
      }
      multiple_before = multiples[k];
      pressure_before = pressures(z, k);
    }
  }
  return largest;
}

std::vector<Session> plan_sessions(const Retention& retention, const std::vector<ZoneForecast>& zones, double between,
                                   double last) {
  for (int n = 1; n <= kMostSessions; ++n) {
    std::vector<Session> sessions = fill(retention, zones, n, between, last);
    const VectorXd left = present_at(retention, sessions, (n - 1) * between + last, static_cast<Index>(zones.size()));
    bool is_reached = true;
    for (size_t z = 0; z < zones.size(); ++z) {
      is_reached = is_reached && left[static_cast<Index>(z)] >= (1.0 - kReached) * zones[z].wanted;
    }
    if (is_reached) return sessions;
  }
  return {};
}

}  // namespace lipofill::forecast
