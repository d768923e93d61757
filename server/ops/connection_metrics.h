#pragma once

#include "server/door/door_figures.h"
#include "server/ops/metrics.h"

namespace lipofill::server {

/// Adds what the door counts: lipofill_connections, lipofill_connections_accepted_total, and for
/// each reason to turn one away lipofill_connections_{reason}_total, such as hostile; and
/// process_max_fds, the bound of process_open_fds. The figures must live longer. Checked by
/// tests/integration/security/descriptors_test.cc.
void add_connection_metrics(const DoorFigures& door, Metrics& metrics);

}  // namespace lipofill::server
