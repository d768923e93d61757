#pragma once

#include <filesystem>
#include <string>

#include "absl/status/status.h"
#include "google/protobuf/message.h"

namespace lipofill::client {

/// Reads the proto3 JSON form of a message from a file. INVALID_ARGUMENT naming the file, with a
/// violation for each unknown field, its path and the nearest known name, and for each name that an
/// enum does not have. Checked by tests/unit/client/plan_file_test.cc.
absl::Status load_message(const std::filesystem::path& path, google::protobuf::Message* message);

/// The proto3 JSON form of a message, with the schema's own field names and no field left out.
std::string message_json(const google::protobuf::Message& message);

/// The same without the fields that are not set, for files that people read and programs take back.
std::string compact_message_json(const google::protobuf::Message& message);

/// The same on one line, with every field, for streams of messages.
std::string message_json_line(const google::protobuf::Message& message);

}  // namespace lipofill::client
