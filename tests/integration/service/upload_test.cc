// Scans: upload in pieces over broken connections and restarts, and what is refused.

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using Patients = v1::PatientService::Stub;
using ::testing::HasSubstr;

class UploadTest : public ServiceTest {
 protected:
  UploadTest() { create_patient(); }

  v1::Scan get_scan(const std::string& name) {
    v1::GetScanRequest request;
    request.set_name(name);
    v1::Scan scan;
    const grpc::Status status = call(*patients_, &Patients::GetScan, request, scan);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return scan;
  }
  std::unique_ptr<grpc::ClientReader<v1::MeshSlice>> download(Context& context, const v1::Scan& scan) {
    v1::DownloadScanMeshRequest request;
    request.set_name(scan.name());
    return patients_->DownloadScanMesh(&context, request);
  }
  int n_scans() {
    v1::ListScansRequest request;
    request.set_parent("patients/anna");
    v1::ListScansResponse scans;
    EXPECT_TRUE(call(*patients_, &Patients::ListScans, request, scans).ok());
    return scans.scans_size();
  }
};

TEST_F(UploadTest, ReadsACompleteScan) {
  v1::Scan scan;
  const grpc::Status status = upload("patients/anna", v1::OBJ, sheet_obj(200), scan);  // several chunks
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(scan.complete());
  EXPECT_EQ(scan.received_bytes(), scan.size_bytes());
  EXPECT_EQ(scan.report().vertices(), 40'000u);
  EXPECT_EQ(scan.report().boundary_loops(), 1u);
  EXPECT_NEAR(scan.report().size_x_mm(), 100.0, 1e-3);
  restart();
  EXPECT_EQ(get_scan(scan.name()).SerializeAsString(), scan.SerializeAsString());
}

TEST_F(UploadTest, GivesTheSurfaceBackInMillimetres) {
  v1::Scan scan;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(60), scan).ok());
  Context context;
  auto stream = download(context, scan);
  auto rows = read_mesh_rows(*stream);
  EXPECT_EQ(rows, (std::map<std::string, uint64_t>{{"scan.points", 3600u}, {"scan.cells", 2u * 59 * 59}}));
}

TEST_F(UploadTest, GivesTheColoursThatAScanHas) {
  const std::string bytes = "v 0 0 0 1 0 0\nv 100 0 0 0 1 0\nv 0 100 0 0 0 1\nf 1 2 3\n";
  v1::Scan scan;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, bytes, scan).ok());
  restart();
  Context context;
  auto stream = download(context, scan);
  v1::MeshSlice slice;
  std::map<std::string, std::string> data;
  while (stream->Read(&slice)) {
    for (const v1::ArraySlice& array : slice.arrays()) data[array.name()] += array.data();
  }
  ASSERT_TRUE(stream->Finish().ok());
  EXPECT_EQ(data["scan.colour"], std::string("\xFF\0\0\0\xFF\0\0\0\xFF", 9));
}

TEST_F(UploadTest, GivesNoSurfaceOfAScanThatIsNotComplete) {
  const v1::Scan scan = create_scan("patients/anna", v1::OBJ, sheet_obj(60));
  Context context;
  auto stream = download(context, scan);
  v1::MeshSlice slice;
  EXPECT_FALSE(stream->Read(&slice));
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::FAILED_PRECONDITION);
}

TEST_F(UploadTest, GoesOnAfterABrokenStreamAndARestart) {
  const std::string bytes = sheet_obj(200);
  const v1::Scan scan = create_scan("patients/anna", v1::OBJ, bytes);
  v1::Scan result;
  ASSERT_TRUE(send(scan, 0, bytes.substr(0, 300'000), result).ok()) << "a part is fine";
  EXPECT_FALSE(result.complete());
  EXPECT_EQ(result.received_bytes(), 300'000u);
  {
    Context context;
    v1::Scan nothing;
    auto stream = patients_->UploadScan(&context, &nothing);
    v1::UploadScanRequest chunk;
    chunk.set_name(scan.name());
    chunk.set_offset(300'000);
    chunk.set_data(bytes.substr(300'000, 100'000));
    stream->Write(chunk);
    context.TryCancel();
    EXPECT_FALSE(stream->Finish().ok());
  }
  restart_hard();
  const uint64_t received = get_scan(scan.name()).received_bytes();
  EXPECT_TRUE(received == 300'000u || received == 400'000u) << received;
  ASSERT_TRUE(send(scan, received, bytes.substr(received), result).ok());
  EXPECT_TRUE(result.complete());
}

TEST_F(UploadTest, RefusesAWrongOffsetAndNamesTheRightOne) {
  const std::string bytes = sheet_obj();
  const v1::Scan scan = create_scan("patients/anna", v1::OBJ, bytes);
  v1::Scan result;
  ASSERT_TRUE(send(scan, 0, bytes.substr(0, 100), result).ok());
  const grpc::Status status = send(scan, 50, bytes.substr(50), result);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(violations_of(status)["offset"], HasSubstr("100"));
  EXPECT_EQ(get_scan(scan.name()).received_bytes(), 100u);
  EXPECT_TRUE(send(scan, 100, bytes.substr(100), result).ok());
}

TEST_F(UploadTest, RefusesMoreThanWasAnnounced) {
  const std::string bytes = sheet_obj();
  const v1::Scan scan = create_scan("patients/anna", v1::OBJ, bytes);
  v1::Scan result;
  const grpc::Status status = send(scan, 0, bytes + "more", result);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(violations_of(status).count("data"), 1u);
}

TEST_F(UploadTest, RemovesAScanOfAnotherHash) {
  std::string bytes = sheet_obj();
  const v1::Scan scan = create_scan("patients/anna", v1::OBJ, bytes);
  bytes[10] = bytes[10] == '1' ? '2' : '1';
  v1::Scan result;
  const grpc::Status status = send(scan, 0, bytes, result);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(violations_of(status).count("sha256"), 1u);
  EXPECT_EQ(n_scans(), 0);
  EXPECT_THAT(store_content(), HasSubstr("0 files of scans"));
}

TEST_F(UploadTest, RefusesAStreamWithoutAName) {
  Context context;
  v1::Scan result;
  auto stream = patients_->UploadScan(&context, &result);
  stream->Write(v1::UploadScanRequest());
  stream->WritesDone();
  EXPECT_EQ(violations_of(stream->Finish()).count("name"), 1u);
  EXPECT_EQ(send(v1::Scan(), 0, "x", result).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  v1::Scan unknown;
  unknown.set_name("patients/anna/scans/none");
  EXPECT_EQ(send(unknown, 0, "x", result).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(UploadTest, CreateIsIdempotentAndChecked) {
  v1::CreateScanRequest request;
  request.set_request_id("r1");
  request.set_parent("patients/anna");
  request.set_format(v1::STL);
  request.set_size_bytes(100);
  request.set_sha256(std::string(64, 'a'));
  v1::Scan first, again;
  ASSERT_TRUE(call(*patients_, &Patients::CreateScan, request, first).ok());
  ASSERT_TRUE(call(*patients_, &Patients::CreateScan, request, again).ok());
  EXPECT_EQ(first.name(), again.name());

  v1::CreateScanRequest bad;
  bad.set_parent("patients/anna");
  bad.set_size_bytes(uint64_t{300} << 20);
  bad.set_sha256("xyz");
  const grpc::Status status = call(*patients_, &Patients::CreateScan, bad, again);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(violations_of(status).size(), 3u) << status.error_message();
  bad = request;
  bad.clear_request_id();
  bad.set_parent("patients/nobody");
  EXPECT_EQ(call(*patients_, &Patients::CreateScan, bad, again).error_code(), grpc::StatusCode::NOT_FOUND);
}

}  // namespace
}  // namespace lipofill::testing
