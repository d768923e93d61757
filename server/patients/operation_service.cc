#include "server/patients/operation_service.h"

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "server/entry/listing.h"
#include "server/entry/operation_answer.h"
#include "server/entry/unary.h"

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
