#include "server/patients/operation_service.h"

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "lipofill/v1/model.pb.h"
#include "server/entry/listing.h"
#include "server/entry/unary.h"
#include "server/wire/error_message.h"
#include "server/wire/timestamps.h"

namespace lipofill::server {
namespace {

constexpr std::chrono::milliseconds kDefaultWait{10'000};
constexpr std::chrono::milliseconds kMaxWait{60'000};

absl::StatusOr<std::chrono::milliseconds> read_timeout(const v1::WaitOperationRequest& request) {
  if (!request.has_timeout()) return kDefaultWait;
  const auto& timeout = request.timeout();
  const double seconds = static_cast<double>(timeout.seconds()) + 1e-9 * timeout.nanos();
  if (!(seconds >= 0.0) || seconds > 60.0) {
    return field_violation("timeout",
                           absl::StrCat("is ", seconds, " s, must be in [0, ", kMaxWait.count() / 1000, "]"));
  }
  return std::chrono::milliseconds(static_cast<int64_t>(seconds * 1e3));
}

}  // namespace

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
    v1::Model model;
    model.ParseFromString(view.response_message);
    operation.mutable_response()->PackFrom(model);
  } else {
    *operation.mutable_error() = to_error_message(view.error);
  }
  return operation;
}

OperationService::Reactor* OperationService::GetOperation(Context* context, const v1::GetOperationRequest* request,
                                                          v1::Operation* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto id = parse_operation_name(request->name(), "name");
    if (!id.ok()) return id.status();
    const auto operation = backend_.operations.get(*id);
    if (operation.ok()) *response = to_operation(backend_, *operation);
    return operation.status();
  });
}

OperationService::Reactor* OperationService::ListOperations(Context* context, const v1::ListOperationsRequest* request,
                                                            v1::ListOperationsResponse* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto page = parse_page("operations", request->page_size(), request->page_token());
    if (!page.ok()) return page.status();
    const auto operations = backend_.operations.list(call_of(context).principal.scope, one_more(*page));
    response->set_next_page_token(fill_page(
        "operations", *page, operations,
        [this, response](const OperationView& view) { *response->add_operations() = to_operation(backend_, view); }));
    return absl::OkStatus();
  });
}

OperationService::Reactor* OperationService::WaitOperation(Context* context, const v1::WaitOperationRequest* request,
                                                           v1::Operation* response) {
  Reactor* reactor = context->DefaultReactor();
  absl::Status valid = check_call(context, *request);
  const auto id = parse_operation_name(request->name(), "name");
  valid.Update(id.status());
  const auto timeout = read_timeout(*request);
  valid.Update(timeout.status());
  if (!valid.ok()) {
    reactor->Finish(to_grpc_status(valid));
    return reactor;
  }
  std::optional<double> seen;
  if (request->has_seen_progress()) seen = request->seen_progress();
  backend_.operations.wait(*id, *timeout, seen,
                           [this, context, reactor, response](const absl::StatusOr<OperationView>& view) {
                             absl::Status done = view.status();
                             done.Update(check_still_known(context));
                             if (done.ok()) *response = to_operation(backend_, *view);
                             reactor->Finish(to_grpc_status(done));
                           });
  return reactor;
}

OperationService::Reactor* OperationService::CancelOperation(Context* context,
                                                             const v1::CancelOperationRequest* request,
                                                             google::protobuf::Empty*) {
  return answer(context, request, [&]() -> absl::Status {
    const auto id = parse_operation_name(request->name(), "name");
    return id.ok() ? backend_.operations.cancel(*id) : id.status();
  });
}

}  // namespace lipofill::server
