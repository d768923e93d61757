#pragma once

#include "server/backend/backend.h"

namespace lipofill::server {

/// Adds what is looked up at each scrape: simulations by state, the largest volume error of their
/// films, and what waits for a thread. The metrics may be scraped as long as the backend lives.
/// Checked by tests/integration/service/metrics_test.cc.
void add_backend_metrics(Backend& backend, Metrics& metrics);

}  // namespace lipofill::server
