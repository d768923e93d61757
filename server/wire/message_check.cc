#include "server/wire/message_check.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/unknown_field_set.h>

#include <cmath>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"

namespace lipofill::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

/// This many are enough to mend an input by; a request of 4 MiB may hold a million.
constexpr size_t kMaxViolations = 20;

class MessageChecker {
 public:
  void check(const Message& message, const std::string& path) {
    check_unknown(message, path);
    std::vector<const FieldDescriptor*> fields;
    message.GetReflection()->ListFields(message, &fields);
    for (const FieldDescriptor* field : fields) {
      if (field->is_repeated()) {
        check_repeated(message, *field, join(path, field->name()));
      } else {
        check_singular(message, *field, join(path, field->name()));
      }
    }
  }

  absl::Status status() const { return violations_.to_status(); }

 private:
  static std::string join(const std::string& path, const std::string& name) {
    return path.empty() ? name : absl::StrCat(path, ".", name);
  }

  void add(const std::string& path, const std::string& what) {
    if (violations_.all().size() < kMaxViolations) violations_.add(path, what);
  }

  void check_unknown(const Message& message, const std::string& path) {
    const auto& unknown = message.GetReflection()->GetUnknownFields(message);
    for (int i = 0; i < unknown.field_count(); ++i) {
      add(path, absl::StrCat("has the unknown field number ", unknown.field(i).number(), " in ",
                             message.GetDescriptor()->full_name()));
    }
  }

  void check_number(double value, const std::string& path) {
    if (!std::isfinite(value)) add(path, absl::StrCat("is ", value, ", must be a finite number"));
  }

  /// Tells whether numbers may be none: samples of a layer's thickness where nothing was measured.
  static bool may_be_unmeasured(const std::string& path) {
    return absl::EndsWith(path, "].thickness_mm.samples.values");
  }

  void check_enumerator(int value, const FieldDescriptor& field, const std::string& path) {
    if (field.enum_type()->FindValueByNumber(value) == nullptr) {
      add(path, absl::StrCat("is ", value, ", which is no ", field.enum_type()->full_name()));
    }
  }

  void check_singular(const Message& message, const FieldDescriptor& field, const std::string& path) {
    const auto& access = *message.GetReflection();
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_MESSAGE:
        return check(access.GetMessage(message, &field), path);
      case FieldDescriptor::CPPTYPE_DOUBLE:
        return check_number(access.GetDouble(message, &field), path);
      case FieldDescriptor::CPPTYPE_FLOAT:
        return check_number(access.GetFloat(message, &field), path);
      case FieldDescriptor::CPPTYPE_ENUM:
        return check_enumerator(access.GetEnumValue(message, &field), field, path);
      default:
        return;
    }
  }

  void check_repeated(const Message& message, const FieldDescriptor& field, const std::string& path) {
    const auto& access = *message.GetReflection();
    if (field.is_map()) return check_map(message, field, path);
    for (int i = 0; i < access.FieldSize(message, &field); ++i) {
      switch (field.cpp_type()) {
        case FieldDescriptor::CPPTYPE_MESSAGE:
          check(access.GetRepeatedMessage(message, &field, i), absl::StrCat(path, "[", i, "]"));
          break;
        case FieldDescriptor::CPPTYPE_DOUBLE:
          if (const double value = access.GetRepeatedDouble(message, &field, i);
              !std::isfinite(value) && !(std::isnan(value) && may_be_unmeasured(path))) {
            check_number(value, absl::StrCat(path, "[", i, "]"));
          }
          break;
        case FieldDescriptor::CPPTYPE_ENUM:
          check_enumerator(access.GetRepeatedEnumValue(message, &field, i), field, absl::StrCat(path, "[", i, "]"));
          break;
        default:
          return;
      }
    }
  }

  void check_map(const Message& message, const FieldDescriptor& field, const std::string& path) {
    const auto& access = *message.GetReflection();
    const FieldDescriptor& key = *field.message_type()->map_key();
    const FieldDescriptor& value = *field.message_type()->map_value();
    if (key.cpp_type() != FieldDescriptor::CPPTYPE_STRING) return;
    for (int i = 0; i < access.FieldSize(message, &field); ++i) {
      const Message& entry = access.GetRepeatedMessage(message, &field, i);
      const std::string name = entry.GetReflection()->GetString(entry, &key);
      check_singular(entry, value, absl::StrCat(path, "[", name, "]"));
    }
  }

  FieldViolations violations_;
};

}  // namespace

absl::Status check_message(const Message& message) {
  MessageChecker checker;
  checker.check(message, "");
  return checker.status();
}

}  // namespace lipofill::server
