#include "server/wire/resource_names.h"

#include <google/protobuf/descriptor.h>

#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_split.h"
#include "server/wire/names.h"

namespace lipofill::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

/// No name is longer: three collections and ids.
constexpr size_t kMaxName = 256;

std::set<std::string>* collection_of(ResourceNames& names, const std::string& text) {
  if (absl::StartsWith(text, "patients/")) return &names.patients;
  if (absl::StartsWith(text, "simulations/")) return &names.simulations;
  if (absl::StartsWith(text, "operations/")) return &names.operations;
  return nullptr;
}

bool is_whole_name(const std::vector<std::string>& parts) {
  if (parts.size() % 2 != 0) return false;
  for (const std::string& part : parts) {
    if (!is_id(part)) return false;
  }
  return true;
}

void add(const std::string& text, ResourceNames& names) {
  std::set<std::string>* ids = text.size() <= kMaxName ? collection_of(names, text) : nullptr;
  if (ids == nullptr) return;
  const std::vector<std::string> parts = absl::StrSplit(text, '/');
  if (!is_id(parts[1])) return;
  ids->insert(parts[1]);
  if (is_whole_name(parts)) names.whole.insert(text);
}

void collect(const Message& message, ResourceNames& names);

void collect_field(const Message& message, const FieldDescriptor& field, ResourceNames& names) {
  const auto& access = *message.GetReflection();
  const int n = field.is_repeated() ? access.FieldSize(message, &field) : 1;
  for (int i = 0; i < n; ++i) {
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
      add(field.is_repeated() ? access.GetRepeatedString(message, &field, i) : access.GetString(message, &field),
          names);
    } else if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      collect(field.is_repeated() ? access.GetRepeatedMessage(message, &field, i) : access.GetMessage(message, &field),
              names);
    }
  }
}

void collect(const Message& message, ResourceNames& names) {
  std::vector<const FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->type() != FieldDescriptor::TYPE_BYTES) collect_field(message, *field, names);
  }
}

}  // namespace

ResourceNames resource_names_in(const Message& message) {
  ResourceNames names;
  collect(message, names);
  return names;
}

}  // namespace lipofill::server
