#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/field_mask.pb.h>
#include <google/protobuf/message.h>

#include <string>

#include "absl/status/status.h"

namespace lipofill::server {

/// Checks a mask. INVALID_ARGUMENT with a violation of `field` for every path that is no field of
/// the message type. An empty mask is good, so is the one path "*": both mean everything. Checked
/// by tests/unit/server/wire/field_mask_test.cc.
absl::Status check_field_mask(const google::protobuf::FieldMask& mask, const google::protobuf::Descriptor& type,
                              const std::string& field);

/// Leaves of a message only what a mask that was checked names.
void apply_field_mask(const google::protobuf::FieldMask& mask, google::protobuf::Message& message);

/// True when a mask that was checked names a field of the message itself.
bool is_masked(const google::protobuf::FieldMask& mask, const std::string& path);

/// Carries out a call with a read mask: checks it, does `read`, which fills the response, and
/// leaves what is wanted of the response.
template <typename Request, typename Response, typename Read>
absl::Status read_masked(const Request& request, Response& response, Read&& read) {
  const absl::Status good = check_field_mask(request.read_mask(), *Response::descriptor(), "read_mask");
  const absl::Status done = good.ok() ? read() : good;
  if (done.ok()) apply_field_mask(request.read_mask(), response);
  return done;
}

}  // namespace lipofill::server
