#include "server/wire/status_mapping.h"

#include <google/protobuf/util/time_util.h>

#include "core/base/error_hints.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "server/wire/error_message.h"

namespace lipofill::server {
namespace {

google::rpc::RetryInfo to_retry_info(double delay_s) {
  google::rpc::RetryInfo info;
  *info.mutable_retry_delay() =
      google::protobuf::util::TimeUtil::MillisecondsToDuration(static_cast<int64_t>(kMillisecondsPerSecond * delay_s));
  return info;
}

}  // namespace

google::rpc::Status to_error_message(const absl::Status& status) {
  google::rpc::Status message;
  message.set_code(static_cast<int>(status.code()));
  message.set_message(std::string(status.message()));
  if (status.ok()) return message;
  const auto violations = field_violations_of(status);
  const auto hints = hints_of(status);
  google::rpc::ErrorInfo info;
  info.set_domain("lipofill");
  info.set_reason(violations.empty() ? absl::StatusCodeToString(status.code()) : "FIELD_VIOLATION");
  if (hints) info.set_reason(hints->reason);
  message.add_details()->PackFrom(info);
  if (hints && hints->retry_delay_s) message.add_details()->PackFrom(to_retry_info(*hints->retry_delay_s));
  if (violations.empty()) return message;
  google::rpc::BadRequest bad_request;
  for (const FieldViolation& violation : violations) {
    auto* entry = bad_request.add_field_violations();
    entry->set_field(violation.field);
    entry->set_description(violation.description);
  }
  message.add_details()->PackFrom(bad_request);
  return message;
}

grpc::Status to_grpc_status(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  // HTTP/2 headers have a bound (8 KiB by default at clients); what does not fit would turn into
  // another error on the way.
  constexpr size_t kMaxMessage = 2000;
  constexpr size_t kMaxDetails = 4000;
  std::string text(status.message());
  if (text.size() > kMaxMessage) text = text.substr(0, kMaxMessage) + " ...";
  std::vector<FieldViolation> violations = field_violations_of(status);
  std::string details = to_error_message(status).SerializeAsString();
  while (details.size() > kMaxDetails && !violations.empty()) {
    violations.resize(violations.size() / 2);
    FieldViolations fewer;
    for (FieldViolation& violation : violations) {
      fewer.add(violation.field.substr(0, 200), violation.description.substr(0, 500));
    }
    const absl::Status shortened = violations.empty() ? absl::Status(status.code(), text) : fewer.to_status();
    google::rpc::Status message = to_error_message(shortened);
    message.set_code(static_cast<int>(status.code()));
    message.set_message(text);
    details = message.SerializeAsString();
  }
  if (details.size() > kMaxDetails) details = to_error_message(absl::Status(status.code(), text)).SerializeAsString();
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), text, details);
}

}  // namespace lipofill::server
