#pragma once

#include <exception>
#include <new>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "server/sessions/memory_reserve.h"

namespace lipofill::server {

/// Carries out `work` for a simulation; whatever it throws becomes a status that names the
/// simulation. Nothing that goes wrong for one of them may reach the others, or cost a caller its
/// answer.
template <typename Work>
absl::Status guard_session(const std::string& id, Work&& work) {
  try {
    const MayFail may_fail;
    return work();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat("simulations/", id, ": out of memory"));
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("simulations/", id, ": ", error.what()));
  }
}

}  // namespace lipofill::server
