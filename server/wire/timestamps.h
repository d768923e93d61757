#pragma once

#include <google/protobuf/timestamp.pb.h>

#include <cstdint>

namespace lipofill::server {

inline google::protobuf::Timestamp to_timestamp(int64_t microseconds) {
  google::protobuf::Timestamp timestamp;
  timestamp.set_seconds(microseconds / 1'000'000);
  timestamp.set_nanos(static_cast<int32_t>(microseconds % 1'000'000) * 1000);
  return timestamp;
}

}  // namespace lipofill::server
