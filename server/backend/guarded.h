#pragma once

#include <exception>
#include <new>

#include "absl/status/status.h"
#include "core/base/unwanted.h"
#include "server/sessions/memory_reserve.h"

namespace lipofill::server {

/// Carries out `work`; whatever it throws becomes a status: nothing may leave the daemon's edge as
/// an exception.
template <typename Work>
absl::Status guarded(Work&& work) {
  try {
    const MayFail may_fail;
    return work();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("out of memory");
  } catch (const std::exception& error) {
    return absl::InternalError(error.what());
  }
}

/// The same, unless nobody wants it: CANCELLED.
template <typename Work>
absl::Status guarded_if_wanted(const Unwanted& unwanted, Work&& work) {
  const absl::Status wanted = check_wanted(unwanted);
  return wanted.ok() ? guarded(work) : wanted;
}

}  // namespace lipofill::server
