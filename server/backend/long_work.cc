#include "server/backend/long_work.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/backend/guarded.h"
#include "server/sessions/shortage.h"
#include "server/wire/operation_response.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

void carry_out(Backend& backend, const std::string& operation, const LongWork& work) {
  absl::StatusOr<std::string> result = absl::UnknownError("");
  const absl::Status status = guarded([&] {
    result = work(operation);
    return result.status();
  });
  if (!status.ok()) {
    result = status;
    spdlog::info("operations/{} failed: {}", operation, status.ToString());
  }
  backend.operations.finish(operation, std::move(result));
}

}  // namespace

absl::StatusOr<OperationView> start_long_work(Backend& backend, const std::string& target, const RequestKey& key,
                                              const std::string& waiting, const std::string& doing, LongWork work) {
  const auto started = backend.operations.start(target, key);
  if (!started.ok()) return started.status();
  if (!started->is_new) return started->operation;
  const std::string id = started->operation.id;
  const bool taken = backend.builds.run([&backend, id, work = std::move(work)] { carry_out(backend, id, work); }, id);
  if (!taken) {
    backend.operations.drop(id);
    return shortage("TOO_MANY_BUILDS", 5.0,
                    absl::StrCat("too many ", waiting, ", the bound is ", backend.builds.max_queued()));
  }
  spdlog::info("operations/{} {} {}", id, doing, target);
  return started->operation;
}

OperationView checked_only(const std::string& target, const google::protobuf::Message& response,
                           const std::string& stage) {
  OperationView view;
  view.target = target;
  view.response_message = pack_response(response);
  view.done = true;
  view.progress = 1.0;
  view.stage = stage;
  return view;
}

}  // namespace lipofill::server
