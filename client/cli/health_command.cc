#include "absl/strings/str_cat.h"
#include "client/cli/application.h"
#include "grpc/health/v1/health.grpc.pb.h"

namespace lipofill::client {
namespace {

absl::StatusOr<ExitCode> health(Application& application) {
  using grpc::health::v1::Health;
  using grpc::health::v1::HealthCheckResponse;
  const auto response = application.connect().call<Health>(&Health::Stub::Check, grpc::health::v1::HealthCheckRequest(),
                                                           std::chrono::seconds(10));
  if (!response.ok()) return response.status();
  const std::string state = HealthCheckResponse::ServingStatus_Name(response->status());
  application.answer(*response, absl::StrCat(application.server, " ", state, "\n"));
  return response->status() == HealthCheckResponse::SERVING ? ExitCode::kOk : ExitCode::kNotPossible;
}

}  // namespace

void add_health_command(CLI::App& root, Application& application) {
  add_command(root, application, "health", "Ask whether the daemon serves",
              "  lipofill health --server 10.0.0.5:50061\n", [&application] { return health(application); });
}

}  // namespace lipofill::client
