#include "server/patients/scan_upload.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/geometry/surface_cleaning.h"
#include "server/backend/scan_reading.h"
#include "server/entry/unary.h"
#include "server/sessions/identifiers.h"
#include "server/store/record_names.h"
#include "server/wire/names.h"
#include "server/wire/report_conversion.h"
#include "server/wire/request_key.h"
#include "server/wire/sha256.h"
#include "server/wire/timestamps.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

constexpr size_t kMaxChunkBytes = size_t{1} << 20;

bool is_sha256(const std::string& text) {
  return text.size() == 64 && std::all_of(text.begin(), text.end(),
                                          [](char c) { return absl::ascii_isxdigit(static_cast<unsigned char>(c)); });
}

absl::Status check_request(const v1::CreateScanRequest& request, uint64_t max_bytes) {
  FieldViolations violations;
  if (request.format() == v1::SCAN_FORMAT_UNSPECIFIED) violations.add("format", "is missing: OBJ, PLY or STL");
  if (request.size_bytes() < 1 || request.size_bytes() > max_bytes) {
    violations.add("size_bytes", absl::StrCat("is ", request.size_bytes(), ", must be in [1, ", max_bytes, "]"));
  }
  if (!is_sha256(request.sha256())) {
    violations.add("sha256", absl::StrCat("is \"", absl::CHexEscape(request.sha256().substr(0, 80)),
                                          "\", must be 64 hexadecimal digits"));
  }
  return violations.to_status();
}

/// One call of UploadScan.
class UploadStream : public grpc::ServerReadReactor<v1::UploadScanRequest> {
 public:
  UploadStream(ScanUploads& uploads, Backend& backend, grpc::CallbackServerContext* context, v1::Scan* response)
      : uploads_(uploads), backend_(backend), context_(context), response_(response) {
    StartRead(&chunk_);
  }

  void OnReadDone(bool ok) override {
    if (!ok) return finish_early();
    const absl::Status taken = guarded([this] { return take_chunk(); });
    if (!taken.ok()) return Finish(to_grpc_status(taken));
    if (record_.received_bytes == record_.size_bytes) return complete();
    StartRead(&chunk_);
  }

  void OnDone() override { delete this; }

 private:
  absl::Status take_chunk() {
    if (const absl::Status valid = check_call(context_, chunk_); !valid.ok()) return valid;
    if (!chunk_.name().empty() && name_.empty()) {
      const auto ids = parse_scan_name(chunk_.name(), "name");
      if (!ids.ok()) return ids.status();
      name_ = chunk_.name();
      ids_ = *ids;
    }
    if (name_.empty()) return field_violation("name", "is missing in the first message");
    if (!chunk_.name().empty() && chunk_.name() != name_) {
      return field_violation("name", "is not that of the first message, " + name_);
    }
    auto record = uploads_.receive(ids_.patient, ids_.id, chunk_.offset(), chunk_.data());
    if (!record.ok()) return record.status();
    record_ = *std::move(record);
    return absl::OkStatus();
  }

  /// The client said that it is done, or has gone, before all bytes were here.
  void finish_early() {
    if (const absl::Status& refusal = call_of(context_).refusal; !refusal.ok()) return Finish(to_grpc_status(refusal));
    if (name_.empty()) return Finish(to_grpc_status(field_violation("name", "is missing: there was no message")));
    *response_ = to_scan(record_);
    Finish(grpc::Status::OK);
  }

  void complete() {
    const bool taken = backend_.calls.run([this] {
      const absl::Status done = guarded([this] {
        const auto record = uploads_.complete(ids_.patient, ids_.id);
        if (record.ok()) *response_ = to_scan(*record);
        return record.status();
      });
      Finish(to_grpc_status(done));
    });
    if (!taken) Finish(to_grpc_status(too_many_calls(backend_)));
  }

  ScanUploads& uploads_;
  Backend& backend_;
  grpc::CallbackServerContext* const context_;
  v1::Scan* const response_;
  v1::UploadScanRequest chunk_;
  std::string name_;
  PatientChild ids_;
  ScanRecord record_;
};

/// Tells what was found in the file, what of it is not in the surface, and what a model will mend.
v1::ScanReport describe_scan(const geometry::ScannedSurface& surface) {
  v1::ScanReport report = to_scan_report(surface, geometry::check_surface(surface));
  for (const std::string& remark : surface.remarks) report.add_read_remarks(remark);
  for (const std::string& remark : geometry::clean_surface(surface).remarks) report.add_mending_remarks(remark);
  return report;
}

}  // namespace

v1::Scan to_scan(const ScanRecord& record) {
  v1::Scan scan;
  scan.set_name(scan_name(record.patient, record.id));
  scan.set_format(static_cast<v1::ScanFormat>(record.format));
  scan.set_unit(static_cast<v1::ScanUnit>(record.unit));
  scan.set_size_bytes(record.size_bytes);
  scan.set_sha256(record.sha256);
  scan.set_received_bytes(record.received_bytes);
  scan.set_complete(record.complete);
  if (record.complete) scan.mutable_report()->ParseFromString(record.report_message);
  *scan.mutable_create_time() = to_timestamp(record.create_time_us);
  return scan;
}

absl::StatusOr<v1::Scan> ScanUploads::create(const Principal& caller, const v1::CreateScanRequest& request) {
  const auto patient = parse_patient_name(request.parent(), "parent");
  if (!patient.ok()) return patient.status();
  if (auto good = check_request_id(request.request_id()); !good.ok()) return good;
  if (auto good = check_request(request, backend_.options.sizes.upload_bytes); !good.ok()) return good;
  ScanRecord record;
  record.patient = *patient;
  record.id = make_id('s');
  record.format = request.format();
  record.unit = request.unit() == v1::SCAN_UNIT_UNSPECIFIED ? v1::MILLIMETRE : request.unit();
  record.size_bytes = request.size_bytes();
  record.sha256 = absl::AsciiStrToLower(request.sha256());
  record.create_time_us = now_us();
  if (request.validate_only()) {
    const auto owner = backend_.store.get_patient(*patient);
    return owner.ok() ? absl::StatusOr<v1::Scan>(to_scan(record)) : owner.status();
  }
  const auto made =
      backend_.store.create_scan(record, make_request_key(caller, "CreateScan", request.request_id(), request));
  if (!made.ok()) return made.status();
  return to_scan(*made);
}

absl::StatusOr<ScanRecord> ScanUploads::find(const std::string& patient, const std::string& scan) {
  auto record = backend_.store.get_scan(patient, scan);
  if (record.ok() && !record->complete) {
    record->received_bytes = std::min(record->received_bytes, backend_.scan_files.size(patient, scan));
  }
  return record;
}

absl::StatusOr<ScanRecord> ScanUploads::receive(const std::string& patient, const std::string& scan, uint64_t offset,
                                                const std::string& data) {
  const std::lock_guard lock(mutex_);
  auto record = find(patient, scan);
  if (!record.ok()) return record;
  if (record->complete || completing_.count(scan_name(patient, scan)) > 0) {
    return absl::FailedPreconditionError(absl::StrCat(scan_name(patient, scan), " has all of its bytes"));
  }
  if (data.size() > kMaxChunkBytes) {
    return field_violation("data", absl::StrCat("has ", data.size(), " bytes, must have at most ", kMaxChunkBytes));
  }
  if (offset != record->received_bytes) {
    return field_violation("offset", absl::StrCat("is ", offset, ", must be ", record->received_bytes,
                                                  ", the number of bytes received so far"));
  }
  if (data.size() > record->size_bytes - offset) {
    return field_violation("data",
                           absl::StrCat("ends at byte ", offset + data.size(), ", size_bytes is ", record->size_bytes));
  }
  if (auto written = backend_.scan_files.write(patient, scan, offset, data); !written.ok()) return written;
  record->received_bytes += data.size();
  if (auto noted = backend_.store.set_scan_received(patient, scan, record->received_bytes); !noted.ok()) return noted;
  if (record->received_bytes == record->size_bytes) completing_.insert(scan_name(patient, scan));
  return record;
}

absl::StatusOr<ScanRecord> ScanUploads::complete(const std::string& patient, const std::string& scan) {
  auto record = backend_.store.get_scan(patient, scan);
  if (record.ok()) record = check_whole(*record);
  const std::lock_guard lock(mutex_);
  completing_.erase(scan_name(patient, scan));
  if (record.ok()) {
    // The scan is complete for good: after a loss of power too.
    if (auto flushed = backend_.scan_files.flush(patient, scan); !flushed.ok()) return flushed;
    if (auto kept = backend_.store.complete_scan(patient, scan, record->report_message); !kept.ok()) return kept;
    record->complete = true;
    spdlog::info("{} is complete, {} bytes", scan_name(patient, scan), record->size_bytes);
  } else if (absl::IsInvalidArgument(record.status())) {
    backend_.store.delete_scan(patient, scan).IgnoreError();
    backend_.temporary_files.remove_deleted();
    spdlog::info("{} is refused and removed: {}", scan_name(patient, scan), record.status().ToString());
  }
  return record;
}

absl::StatusOr<ScanRecord> ScanUploads::check_whole(const ScanRecord& record) {
  const auto bytes = backend_.scan_files.read(record.patient, record.id);
  if (!bytes.ok()) return bytes.status();
  const std::string sha256 = compute_sha256(*bytes);
  if (sha256 != record.sha256) {
    return field_violation("sha256", absl::StrCat("was announced as ", record.sha256, ", the bytes received have ",
                                                  sha256, "; the scan is removed"));
  }
  const auto surface = parse_scan(record, *bytes);
  if (!surface.ok()) {
    FieldViolations violations;
    violations.absorb("data", surface.status());
    return violations.to_status();
  }
  ScanRecord whole = record;
  whole.received_bytes = record.size_bytes;
  whole.report_message = describe_scan(*surface).SerializeAsString();
  return whole;
}

grpc::ServerReadReactor<v1::UploadScanRequest>* ScanUploads::upload(grpc::CallbackServerContext* context,
                                                                    v1::Scan* response) {
  return new UploadStream(*this, backend_, context, response);
}

}  // namespace lipofill::server
