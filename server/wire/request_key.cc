#include "server/wire/request_key.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "core/base/hash.h"

namespace lipofill::server {

std::string serialize_in_order(const google::protobuf::Message& message) {
  std::string bytes;
  google::protobuf::io::StringOutputStream sink(&bytes);
  google::protobuf::io::CodedOutputStream out(&sink);
  out.SetSerializationDeterministic(true);
  message.SerializeToCodedStream(&out);
  out.Trim();
  return bytes;
}

RequestKey make_request_key(const Principal& caller, const std::string& method, const std::string& request_id,
                            const google::protobuf::Message& request) {
  if (request_id.empty()) return {method, "", "", caller.scope.tenant};
  Hasher hasher;
  hasher.add(serialize_in_order(request));
  return {method, request_id, hasher.hex_digest(), caller.scope.tenant};
}

}  // namespace lipofill::server
