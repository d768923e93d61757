#include "tests/integration/chaos/uploader.h"

#include "absl/strings/str_cat.h"
#include "server/wire/sha256.h"
#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using Patients = v1::PatientService::Stub;
constexpr char kPatient[] = "uploads";
constexpr size_t kChunk = 2000;

}  // namespace

void Uploader::run(const std::atomic<bool>& stop) {
  v1::CreatePatientRequest request;
  request.set_patient_id(kPatient);
  request.set_request_id("upload-patient");
  v1::Patient patient;
  const grpc::Status status =
      ask_until_answered<v1::PatientService>(daemon_, &Patients::CreatePatient, request, patient);
  ASSERT_TRUE(status.ok()) << status.error_message();
  while (!stop && !::testing::Test::HasFailure()) upload_one();
}

void Uploader::upload_one() {
  const std::string bytes = sheet_obj(12 + scans_ % 9, 5.0 + scans_);
  v1::CreateScanRequest request;
  request.set_parent(absl::StrCat("patients/", kPatient));
  request.set_format(v1::OBJ);
  request.set_size_bytes(bytes.size());
  request.set_sha256(server::compute_sha256(bytes));
  request.set_request_id(absl::StrCat("scan-", ++scans_));
  v1::Scan scan;
  const grpc::Status status = ask_until_answered<v1::PatientService>(daemon_, &Patients::CreateScan, request, scan);
  ASSERT_TRUE(status.ok()) << status.error_message();
  while (!send_rest(scan.name(), bytes) && !::testing::Test::HasFailure()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  complete_[scan.name()] = request.sha256();
}

bool Uploader::send_rest(const std::string& name, const std::string& bytes) {
  v1::GetScanRequest get;
  get.set_name(name);
  v1::Scan scan;
  const grpc::Status got = ask_until_answered<v1::PatientService>(daemon_, &Patients::GetScan, get, scan);
  EXPECT_TRUE(got.ok()) << name << " was acknowledged: " << got.error_message();
  if (!got.ok() || scan.complete()) return true;
  const auto stub = v1::PatientService::NewStub(daemon_.channel());
  grpc::ClientContext context;
  auto stream = stub->UploadScan(&context, &scan);
  bool first = true;
  for (size_t begin = scan.received_bytes(); first || begin < bytes.size(); begin += kChunk) {
    v1::UploadScanRequest chunk;
    if (first) chunk.set_name(name);
    first = false;
    chunk.set_offset(begin);
    chunk.set_data(bytes.substr(begin, kChunk));
    if (!stream->Write(chunk)) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  stream->WritesDone();
  const grpc::Status status = stream->Finish();
  EXPECT_TRUE(status.ok() || is_unanswered(status) || status.error_code() == grpc::StatusCode::ABORTED)
      << name << ": " << status.error_code() << " " << status.error_message();
  return status.ok() && scan.complete();
}

void Uploader::check() {
  for (const auto& [name, sha256] : complete_) {
    v1::GetScanRequest get;
    get.set_name(name);
    v1::Scan scan;
    const grpc::Status got = ask_until_answered<v1::PatientService>(daemon_, &Patients::GetScan, get, scan);
    EXPECT_TRUE(got.ok()) << name << ": " << got.error_message();
    EXPECT_TRUE(scan.complete()) << name;
    EXPECT_EQ(scan.sha256(), sha256);
  }
}

}  // namespace lipofill::testing
