#include "client/cpp/errors.h"

#include <nlohmann/json.hpp>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace lipofill::client {
namespace {

constexpr char kPayloadUrl[] = "type.googleapis.com/google.rpc.Status";

google::rpc::Status wire_status_of(const absl::Status& status) {
  google::rpc::Status wire;
  const auto payload = status.GetPayload(kPayloadUrl);
  if (!payload || !wire.ParseFromString(std::string(*payload))) wire.Clear();
  return wire;
}

}  // namespace

absl::Status status_of(const google::rpc::Status& wire) {
  absl::Status status(static_cast<absl::StatusCode>(wire.code()), wire.message());
  if (!status.ok() && wire.details_size() > 0) status.SetPayload(kPayloadUrl, absl::Cord(wire.SerializeAsString()));
  return status;
}

absl::Status invalid_fields(std::string_view message, const std::vector<FieldViolation>& violations) {
  google::rpc::BadRequest bad_request;
  for (const FieldViolation& violation : violations) {
    auto* added = bad_request.add_field_violations();
    added->set_field(violation.field);
    added->set_description(violation.description);
  }
  google::rpc::Status wire;
  wire.set_code(static_cast<int>(absl::StatusCode::kInvalidArgument));
  wire.set_message(std::string(message));
  wire.add_details()->PackFrom(bad_request);
  return status_of(wire);
}

ErrorDetails error_details_of(const absl::Status& status) {
  ErrorDetails details;
  const google::rpc::Status wire = wire_status_of(status);
  for (const google::protobuf::Any& any : wire.details()) {
    google::rpc::ErrorInfo info;
    google::rpc::BadRequest bad_request;
    if (any.UnpackTo(&info)) {
      details.reason = info.reason();
      details.metadata.insert(info.metadata().begin(), info.metadata().end());
    } else if (any.UnpackTo(&bad_request)) {
      for (const auto& violation : bad_request.field_violations()) {
        details.violations.push_back({violation.field(), violation.description()});
      }
    }
  }
  return details;
}

std::string error_text(const absl::Status& status) {
  const ErrorDetails details = error_details_of(status);
  if (details.violations.empty()) return std::string(status.message());
  std::string text = details.violations.size() == 1
                         ? "one thing is wrong with the input:"
                         : absl::StrCat(details.violations.size(), " things are wrong with the input:");
  for (const FieldViolation& violation : details.violations) {
    absl::StrAppend(&text, "\n  ", violation.field, ": ", violation.description);
  }
  return text;
}

std::string error_json(const absl::Status& status) {
  const ErrorDetails details = error_details_of(status);
  nlohmann::ordered_json error = {{"code", absl::StatusCodeToString(status.code())},
                                  {"message", std::string(status.message())},
                                  {"reason", details.reason},
                                  {"field_violations", nlohmann::ordered_json::array()}};
  for (const FieldViolation& violation : details.violations) {
    error["field_violations"].push_back({{"field", violation.field}, {"description", violation.description}});
  }
  return nlohmann::ordered_json{{"error", error}}.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace lipofill::client
