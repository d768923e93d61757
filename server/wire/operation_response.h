#pragma once

#include <google/protobuf/any.pb.h>
#include <google/protobuf/message.h>

#include <string>

namespace lipofill::server {

/// The response of an operation as Operations keeps it, whatever its type.
inline std::string pack_response(const google::protobuf::Message& response) {
  google::protobuf::Any any;
  any.PackFrom(response);
  return any.SerializeAsString();
}

}  // namespace lipofill::server
