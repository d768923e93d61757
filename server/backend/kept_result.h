#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/shared_cache.h"
#include "server/sessions/viewer.h"
#include "server/store/store.h"
#include "server/wire/frame_encoding.h"

namespace lipofill::server {

/// The messages that show the result of a simulation which has ended.
struct KeptMessages {
  EncodedMessages meshes;
  EncodedMessages frame;
};

/// Results from the store as viewers see them. Those who ask for the same share the messages while
/// one of them is being sent any: viewers who do not read cost no memory of their own. Thread-safe.
/// Checked by tests/unit/server/backend/kept_result_test.cc.
class KeptResults {
 public:
  explicit KeptResults(Store& store) : store_(store) {}

  /// Returns the messages that show a result. NOT_FOUND without a result; field violations for
  /// meshes or fields that it has not.
  absl::StatusOr<std::shared_ptr<const KeptMessages>> show(const std::string& simulation, const ViewerOptions& options);

 private:
  Store& store_;
  SharedCache<KeptMessages> shown_;
};

}  // namespace lipofill::server
