#pragma once

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "lipofill/v1/frame_service.grpc.pb.h"
#include "lipofill/v1/operation_service.grpc.pb.h"
#include "lipofill/v1/patient_service.grpc.pb.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"
#include "tests/integration/service/daemon_process.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::testing {

using Context = grpc::ClientContext;

template <typename Message>
Message parse_text(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

inline bool has_ended(v1::Simulation::State state) {
  return state >= v1::Simulation::SETTLED && state <= v1::Simulation::FAILED;
}

/// The field violations a failed call carries, field to description.
std::map<std::string, std::string> violations_of(const grpc::Status& status);
std::map<std::string, std::string> violations_of(const google::rpc::Status& status);

/// Reads a download of meshes to its end; the number of rows by name of the array.
std::map<std::string, uint64_t> read_mesh_rows(grpc::ClientReader<v1::MeshSlice>& stream);

/// What a viewer put together from the slices of one frame.
struct SeenFrame {
  v1::FrameSlice slice;                          ///< is the last slice, without its arrays
  std::map<std::string, std::string> bytes;      ///< an array's name has its bytes
  std::map<std::string, v1::ArraySlice> arrays;  ///< what else is told of them
  uint64_t skipped = 0;
};

/// Reads whole meshes and frames from a Watch.
class Watcher {
 public:
  Watcher(grpc::ChannelInterface& channel, const v1::WatchRequest& request);
  /// The next frame; false when the stream ends.
  bool next(SeenFrame& frame);
  /// Reads on to the end; returns the number of frames.
  int drain(SeenFrame* last = nullptr);
  /// Until the first message is on its way, which is not read.
  void await_sending() { stream_->WaitForInitialMetadata(); }
  grpc::Status finish() { return stream_->Finish(); }
  void cancel() { context_.TryCancel(); }

  std::map<std::string, std::string> meshes;  ///< bytes by name of the array
  std::string topology_hash;
  std::vector<v1::Heartbeat> heartbeats;

 private:
  std::unique_ptr<v1::FrameService::Stub> stub_;
  Context context_;
  std::unique_ptr<grpc::ClientReader<v1::WatchResponse>> stream_;
};

/// A daemon over TCP with the real generated stubs, restarted at will on the same data.
class ServiceTest : public ::testing::Test {
 protected:
  explicit ServiceTest(std::vector<std::string> arguments = {});

  void connect();
  void restart();
  void restart_hard();

  v1::Patient create_patient(const std::string& id = "anna");
  /// Uploads the bytes whole.
  grpc::Status upload(const std::string& patient, v1::ScanFormat format, const std::string& bytes, v1::Scan& scan);
  v1::Scan create_scan(const std::string& patient, v1::ScanFormat format, const std::string& bytes);
  grpc::Status send(const v1::Scan& scan, uint64_t offset, const std::string& data, v1::Scan& result);
  grpc::Status build(const std::string& patient, const v1::ModelSpec& spec, v1::Operation& done);
  /// A small square with two layers.
  v1::Model build_square(const std::string& patient = "patients/anna");
  v1::ModelSpec square_spec() const;
  /// A plan on it that ends after `end_s` and is never settled.
  v1::SimulationSpec square_plan(const std::string& model, double end_s) const;
  grpc::Status create_simulation(const v1::SimulationSpec& spec, const std::string& id, bool start,
                                 v1::Simulation& simulation);
  v1::Simulation get_simulation(const std::string& name);
  /// Polls until it has ended.
  v1::Simulation await_end(const std::string& name);
  bool is_serving();
  /// Calls a method, whether it streams or not, with one message of these bytes; for calls that are
  /// to fail.
  grpc::Status call_raw(const std::string& method, const std::string& bytes);
  /// Everything the store lists, as text.
  std::string store_content();

  TemporaryDirectory directory_;
  std::vector<std::string> arguments_;
  std::unique_ptr<DaemonProcess> daemon_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::PatientService::Stub> patients_;
  std::unique_ptr<v1::OperationService::Stub> operations_;
  std::unique_ptr<v1::SimulationService::Stub> simulations_;
  std::unique_ptr<v1::FrameService::Stub> frames_;
};

/// Calls `method` of a stub: `call(stub, &Stub::Method, request, response)`.
template <typename Stub, typename Method, typename Request, typename Response>
grpc::Status call(Stub& stub, Method method, const Request& request, Response& response) {
  Context context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(120));
  return (stub.*method)(&context, request, &response);
}

/// A slightly curved sheet of n x n vertices, 100 mm wide, as OBJ.
std::string sheet_obj(int n = 12, double height_mm = 5.0);

}  // namespace lipofill::testing
