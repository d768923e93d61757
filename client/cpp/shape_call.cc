#include "client/cpp/shape_call.h"

#include <utility>

#include "client/cpp/array_assembler.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {

absl::StatusOr<SettledShape> find_shape(const Connection& connection, const v1::FindShapeRequest& request) {
  const auto stub = v1::SimulationService::NewStub(connection.channel());
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + Connection::kCreationTimeout);
  std::stop_callback cancel(connection.stop(), [&context] { context.TryCancel(); });
  const auto reader = stub->FindShape(&context, request);
  SettledShape found;
  ArrayAssembler assembler;
  absl::Status assembled;
  v1::FindShapeResponse response;
  while (reader->Read(&response)) {
    if (response.has_shape()) found.figures = std::move(*response.mutable_shape());
    for (const v1::ArraySlice& slice : response.frame().fields()) assembled.Update(assembler.add(slice));
  }
  if (absl::Status status = status_of(reader->Finish(), connection.server()); !status.ok()) return status;
  if (!assembled.ok()) return assembled;
  auto fields = assembler.take();
  if (!fields.ok()) return fields.status();
  found.fields = *std::move(fields);
  return found;
}

}  // namespace lipofill::client
