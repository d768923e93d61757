#pragma once

#include <string>

namespace lipofill::server {

/// Names the calling thread, for top, perf and debuggers; the kernel takes 15 characters.
void name_this_thread(const std::string& name);

}  // namespace lipofill::server
