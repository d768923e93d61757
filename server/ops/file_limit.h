#pragma once

#include <cstddef>

namespace lipofill::server {

/// Raises the number of files and connections that this process may have open as far as it may
/// raise it itself, and returns it. To be called before what bounds itself by it.
size_t raise_file_limit();
/// Returns the number as it is.
size_t file_limit();

/// Connections that fit into so many files: each takes three, and a part of the files is for the
/// store, the logs and the metrics. At least 16. Checked by
/// tests/unit/server/ops/self_check_test.cc.
size_t connections_within(size_t files);

}  // namespace lipofill::server
