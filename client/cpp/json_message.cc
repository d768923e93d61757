#include "client/cpp/json_message.h"

#include <google/protobuf/util/json_util.h>

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/cpp/errors.h"
#include "client/cpp/json_file.h"
#include "client/cpp/nearest_name.h"

namespace lipofill::client {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;
using nlohmann::json;

const FieldDescriptor* find_field(const Descriptor& type, const std::string& key) {
  if (const FieldDescriptor* field = type.FindFieldByName(key)) return field;
  return type.FindFieldByCamelcaseName(key);
}

std::string describe_unknown(const Descriptor& type, const std::string& key) {
  std::vector<std::string> names;
  for (int i = 0; i < type.field_count(); ++i) names.emplace_back(type.field(i)->name());
  const std::string nearest = find_nearest_name(key, names);
  if (!nearest.empty()) return absl::StrCat("no such field; did you mean ", nearest, "?");
  return absl::StrCat("no such field; ", type.name(), " has ", absl::StrJoin(names, ", "));
}

void find_unknown_fields(const json& value, const Descriptor& type, const std::string& path,
                         std::vector<FieldViolation>* violations);

/// Numbers stand for values too: what they mean is for the daemon to judge.
void find_unknown_name(const json& value, const EnumDescriptor& type, const std::string& path,
                       std::vector<FieldViolation>* violations) {
  if (!value.is_string()) return;
  const std::string& name = value.get_ref<const std::string&>();
  if (type.FindValueByName(name) != nullptr) return;
  std::string names;
  for (int i = 0; i < type.value_count(); ++i) {
    const bool stands_for_none = type.value(i)->name().ends_with("_UNSPECIFIED");
    if (!stands_for_none) absl::StrAppend(&names, names.empty() ? "" : ", ", type.value(i)->name());
  }
  violations->push_back({path, absl::StrCat("is \"", name, "\", must be one of ", names)});
}

void find_unknown_in_field(const json& value, const FieldDescriptor& field, const std::string& path,
                           std::vector<FieldViolation>* violations) {
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_ENUM) {
    if (!value.is_array()) return find_unknown_name(value, *field.enum_type(), path, violations);
    for (size_t i = 0; i < value.size(); ++i) {
      find_unknown_name(value[i], *field.enum_type(), absl::StrCat(path, "[", i, "]"), violations);
    }
  }
  if (field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) return;
  if (field.is_map()) {
    const FieldDescriptor* mapped = field.message_type()->map_value();
    if (!value.is_object()) return;
    for (const auto& [key, entry] : value.items()) {
      find_unknown_in_field(entry, *mapped, absl::StrCat(path, "[", key, "]"), violations);
    }
  } else if (field.is_repeated() && value.is_array()) {
    for (size_t i = 0; i < value.size(); ++i) {
      find_unknown_fields(value[i], *field.message_type(), absl::StrCat(path, "[", i, "]"), violations);
    }
  } else {
    find_unknown_fields(value, *field.message_type(), path, violations);
  }
}

/// The recursion is as deep as the schema, which has no message inside itself.
void find_unknown_fields(const json& value, const Descriptor& type, const std::string& path,
                         std::vector<FieldViolation>* violations) {
  // Timestamps and the like have a JSON form of their own.
  if (!value.is_object() || type.file()->package() == "google.protobuf") return;
  for (const auto& [key, entry] : value.items()) {
    const std::string field_path = path.empty() ? key : absl::StrCat(path, ".", key);
    const FieldDescriptor* field = find_field(type, key);
    if (field == nullptr) {
      violations->push_back({field_path, describe_unknown(type, key)});
    } else {
      find_unknown_in_field(entry, *field, field_path, violations);
    }
  }
}

std::string to_json(const google::protobuf::Message& message, bool whitespace, bool with_unset = true) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = whitespace;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = with_unset;
  std::string text;
  // Fails only for an Any of a type this program does not know, which then prints as nothing.
  (void)google::protobuf::util::MessageToJsonString(message, &text, options);
  return text;
}

}  // namespace

absl::Status load_message(const std::filesystem::path& path, google::protobuf::Message* message) {
  const auto document = read_json_file(path);
  if (!document.ok()) return document.status();
  if (!document->is_object()) return absl::InvalidArgumentError(absl::StrCat(path.string(), " is not a JSON object"));
  std::vector<FieldViolation> violations;
  find_unknown_fields(*document, *message->GetDescriptor(), "", &violations);
  if (!violations.empty()) {
    for (FieldViolation& violation : violations) absl::StrAppend(&violation.description, " (in ", path.string(), ")");
    return invalid_fields(absl::StrCat(path.string(), " has unknown fields or names"), violations);
  }
  const auto parsed = google::protobuf::util::JsonStringToMessage(document->dump(), message);
  if (!parsed.ok()) return absl::InvalidArgumentError(absl::StrCat(path.string(), ": ", std::string(parsed.message())));
  return absl::OkStatus();
}

std::string message_json(const google::protobuf::Message& message) {
  return to_json(message, true);
}
std::string compact_message_json(const google::protobuf::Message& message) {
  return to_json(message, true, false);
}
std::string message_json_line(const google::protobuf::Message& message) {
  return to_json(message, false) + "\n";
}

}  // namespace lipofill::client
