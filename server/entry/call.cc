#include "server/entry/call.h"

#include <algorithm>
#include <array>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "server/sessions/identifiers.h"

namespace lipofill::server {
namespace {

constexpr size_t kMaxRequestId = 64;

std::string value_of(const Metadata& metadata, const char* key) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? "" : std::string(found->second.data(), found->second.size());
}

bool is_request_id(const std::string& text) {
  const auto fits = [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == ':' || c == '-';
  };
  return !text.empty() && text.size() <= kMaxRequestId && std::all_of(text.begin(), text.end(), fits);
}

/// Lower-case hexadecimal digits, not all zero.
bool is_hex_id(const std::string& text, size_t length) {
  constexpr char kDigits[] = "0123456789abcdef";
  return text.size() == length && text.find_first_not_of(kDigits) == std::string::npos &&
         text.find_first_not_of('0') != std::string::npos;
}

}  // namespace

LogFields Call::log_fields() const {
  LogFields fields = {{"request_id", request_id}};
  if (!trace_id.empty()) fields.insert(fields.end(), {{"trace_id", trace_id}, {"parent_id", parent_id}});
  return fields;
}

Call read_call(const std::string& method, const Metadata& metadata) {
  Call call;
  call.method = method;
  call.request_id = value_of(metadata, "x-request-id");
  if (!is_request_id(call.request_id)) call.request_id = make_id('r');
  const std::vector<std::string> parts = absl::StrSplit(value_of(metadata, "traceparent"), '-');
  if (parts.size() == 4 && parts[0] == "00" && is_hex_id(parts[1], 32) && is_hex_id(parts[2], 16)) {
    call.trace_id = parts[1];
    call.parent_id = parts[2];
  }
  return call;
}

Call& call_of(grpc::CallbackServerContext* context) {
  return *static_cast<CallContext*>(context)->call;
}

}  // namespace lipofill::server
