#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cli/application.h"
#include "client/cli/describe.h"
#include "client/cli/listing.h"
#include "client/cpp/model_build.h"
#include "lipofill/v1/operation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::OperationService;
using Stub = OperationService::Stub;

absl::StatusOr<ExitCode> get(Application& application, const std::string& name) {
  v1::GetOperationRequest request;
  request.set_name(full_name("operations", name));
  const auto operation = application.connect().call<OperationService>(&Stub::GetOperation, request);
  if (!operation.ok()) return operation.status();
  return application.answer(*operation, describe(*operation));
}

absl::StatusOr<ExitCode> wait(Application& application, const std::string& name) {
  const Connection connection = application.connect();
  v1::GetOperationRequest request;
  request.set_name(full_name("operations", name));
  auto operation = connection.call<OperationService>(&Stub::GetOperation, request);
  if (!operation.ok()) return operation.status();
  const auto done = wait_operation(connection, *std::move(operation));
  if (!done.ok()) return done.status();
  return application.answer(*done, describe(*done));
}

absl::StatusOr<ExitCode> list(Application& application) {
  const auto all =
      list_all<OperationService>(application.connect(), &Stub::ListOperations, v1::ListOperationsRequest(),
                                 [](v1::ListOperationsResponse& response) { return response.mutable_operations(); });
  if (!all.ok()) return all.status();
  std::string text;
  for (const v1::Operation& operation : all->operations()) text += list_line(operation);
  return application.answer(*all, text);
}

absl::StatusOr<ExitCode> cancel(Application& application, const std::string& name) {
  v1::CancelOperationRequest request;
  request.set_name(full_name("operations", name));
  const auto cancelled = application.connect().call<OperationService>(&Stub::CancelOperation, request);
  if (!cancelled.ok()) return cancelled.status();
  return application.done(absl::StrCat("asked ", request.name(), " to stop"));
}

}  // namespace

void add_operation_commands(CLI::App& root, Application& application) {
  CLI::App* group = add_group(root, "operation", "Long-running operations of the daemon");
  const auto name = std::make_shared<std::string>();
  const auto add_named = [&](const char* word, const char* description, auto action) {
    add_command(*group, application, word, description,
                absl::StrCat("  lipofill operation ", word, " operations/abc\n"),
                [&application, name, action] { return action(application, *name); })
        ->add_option("operation", *name, "operations/ID, or the ID alone")
        ->required();
  };
  add_named("get", "Show an operation", get);
  add_named("wait", "Wait until an operation is done", wait);
  add_named("cancel", "Ask an operation to stop", cancel);
  add_command(*group, application, "list", "List all operations", "  lipofill operation list\n",
              [&application] { return list(application); });
}

}  // namespace lipofill::client
