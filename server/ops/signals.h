#pragma once

#include <chrono>
#include <functional>
#include <optional>

namespace lipofill::server {

/// Holds SIGTERM and SIGINT back, from here on, for wait_for_signal(), whichever thread they reach;
/// threads started later are not interrupted by them. SIGPIPE and SIGXFSZ are ignored. To be called
/// once, before the first thread is started.
void take_signals();

/// Waits for SIGTERM or SIGINT and returns its number. Meanwhile calls `tick` every period, where
/// there is one.
int wait_for_signal(std::optional<std::chrono::microseconds> period, const std::function<void()>& tick);

}  // namespace lipofill::server
