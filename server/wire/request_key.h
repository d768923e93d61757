#pragma once

#include <google/protobuf/message.h>

#include <string>

#include "server/security/principal.h"
#include "server/store/records.h"

namespace lipofill::server {

/// The bytes of a message, maps in order: equal for equal messages of this daemon.
std::string serialize_in_order(const google::protobuf::Message& message);

/// Makes the key by which a create is idempotent: a request_id stands for one request of a tenant,
/// byte for byte, maps in order.
RequestKey make_request_key(const Principal& caller, const std::string& method, const std::string& request_id,
                            const google::protobuf::Message& request);

}  // namespace lipofill::server
