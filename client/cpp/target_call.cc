#include "client/cpp/target_call.h"

#include <utility>

#include "client/cpp/array_assembler.h"
#include "lipofill/v1/patient_service.grpc.pb.h"
#include "lipofill/v1/planning_service.grpc.pb.h"

namespace lipofill::client {
namespace {

constexpr std::chrono::seconds kMeasuringTimeout{300};

}  // namespace

absl::StatusOr<v1::Target> make_target(const Connection& connection, const v1::MakeTargetRequest& request,
                                       const BuildProgress& progress) {
  const auto operation = connection.call<v1::PlanningService>(&v1::PlanningService::Stub::MakeTarget, request);
  if (!operation.ok()) return operation.status();
  v1::Target target;
  const absl::Status done = finish_operation(connection, *operation, progress, &target);
  if (!done.ok()) return done;
  return target;
}

absl::StatusOr<v1::Deficit> measure_deficit(const Connection& connection, const v1::MeasureDeficitRequest& request) {
  return connection.call<v1::PlanningService>(&v1::PlanningService::Stub::MeasureDeficit, request, kMeasuringTimeout);
}

absl::StatusOr<std::vector<Array>> download_scan_mesh(const Connection& connection, const std::string& scan) {
  const auto stub = v1::PatientService::NewStub(connection.channel());
  grpc::ClientContext context;
  std::stop_callback cancel(connection.stop(), [&context] { context.TryCancel(); });
  v1::DownloadScanMeshRequest request;
  request.set_name(scan);
  const auto reader = stub->DownloadScanMesh(&context, request);
  ArrayAssembler assembler;
  v1::MeshSlice slice;
  absl::Status status;
  while (status.ok() && reader->Read(&slice)) {
    for (int i = 0; status.ok() && i < slice.arrays_size(); ++i) status = assembler.add(slice.arrays(i));
  }
  if (!status.ok()) context.TryCancel();
  const absl::Status finished = status_of(reader->Finish(), connection.server());
  if (!status.ok()) return status;
  if (!finished.ok()) return finished;
  return assembler.take();
}

void set_landmarks(const Landmarks& landmarks, google::protobuf::Map<std::string, v1::Vector3>* field) {
  for (const auto& [name, point] : landmarks.points_mm) {
    v1::Vector3& position = (*field)[name];
    position.set_x(point[0]);
    position.set_y(point[1]);
    position.set_z(point[2]);
  }
}

}  // namespace lipofill::client
