#include "server/entry/operation_answer.h"

#include "absl/strings/str_cat.h"
#include "server/wire/error_message.h"
#include "server/wire/timestamps.h"

namespace lipofill::server {

v1::Operation to_operation(const Backend& backend, const OperationView& view) {
  v1::Operation operation;
  if (!view.id.empty()) operation.set_name(absl::StrCat("operations/", view.id));
  operation.set_target(view.target);
  operation.set_done(view.done);
  operation.set_progress(view.progress);
  operation.set_stage(view.stage);
  *operation.mutable_create_time() = to_timestamp(view.create_time_us);
  if (!view.done) {
    operation.set_queue_position(static_cast<uint32_t>(backend.builds.position(view.id)));
    return operation;
  }
  if (view.error.ok()) {
    operation.mutable_response()->ParseFromString(view.response_message);
  } else {
    *operation.mutable_error() = to_error_message(view.error);
  }
  return operation;
}

}  // namespace lipofill::server
