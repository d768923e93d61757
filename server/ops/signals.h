#pragma once

namespace lipofill::server {

/// Keeps SIGTERM and SIGINT from interrupting any thread; to be called before the first one is started. SIGPIPE and
/// SIGXFSZ are ignored.
void block_signals();

/// Waits for SIGTERM or SIGINT and returns its number.
int wait_for_signal();

}  // namespace lipofill::server
