#include "client/cli/scanned_colours.h"

#include <algorithm>

#include "client/cpp/target_call.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

bool have_same_points(const std::vector<Array>& one, const std::vector<Array>& other) {
  const Array* const a = find_array(one, "scan.points");
  const Array* const b = find_array(other, "scan.points");
  return a != nullptr && b != nullptr && a->type == b->type && a->bytes == b->bytes;
}

}  // namespace

void add_scanned_colours(const Connection& connection, const v1::Simulation& simulation, std::vector<Array>* meshes) {
  if (find_array(*meshes, "scan.points") == nullptr) return;
  v1::GetModelRequest request;
  request.set_name(simulation.spec().model());
  const auto model = connection.call<v1::PatientService>(&v1::PatientService::Stub::GetModel, request);
  if (!model.ok() || !model->spec().has_scan_region()) return;
  const auto scan = download_scan_mesh(connection, model->spec().scan_region().scan());
  if (!scan.ok() || !have_same_points(*scan, *meshes)) return;
  const Array* const colours = find_array(*scan, "scan.colour");
  if (colours != nullptr) meshes->push_back(*colours);
}

}  // namespace lipofill::client
