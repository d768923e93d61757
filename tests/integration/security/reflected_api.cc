#include "tests/integration/security/reflected_api.h"

#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/unknown_field_set.h>
#include <gtest/gtest.h>

namespace lipofill::testing {
namespace {

using google::protobuf::UnknownFieldSet;

constexpr char kReflection[] = "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";

// Fields of grpc/reflection/v1alpha/reflection.proto, of which gRPC's packages have no generated
// code.
constexpr int kFileContainingSymbol = 4;
constexpr int kListServices = 7;
constexpr int kFileDescriptorResponse = 4;
constexpr int kListServicesResponse = 6;

std::vector<std::string> texts_of(const std::string& message, int field) {
  UnknownFieldSet fields;
  EXPECT_TRUE(fields.ParseFromString(message));
  std::vector<std::string> texts;
  for (int i = 0; i < fields.field_count(); ++i) {
    if (fields.field(i).number() == field) texts.push_back(fields.field(i).length_delimited());
  }
  return texts;
}

std::string ask(const Caller& caller, int field, const std::string& text, int answer_field) {
  UnknownFieldSet request;
  request.AddLengthDelimited(field, text);
  std::string bytes;
  request.SerializeToString(&bytes);
  const Answer answer = caller.call_bytes(kReflection, bytes);
  EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
  if (answer.messages.size() != 1) return "";
  const auto parts = texts_of(answer.messages[0], answer_field);
  return parts.empty() ? "" : parts[0];
}

void add_methods(const Caller& caller, const std::string& service, std::set<std::string>& methods) {
  for (const std::string& bytes : texts_of(ask(caller, kFileContainingSymbol, service, kFileDescriptorResponse), 1)) {
    google::protobuf::FileDescriptorProto file;
    EXPECT_TRUE(file.ParseFromString(bytes));
    for (const auto& described : file.service()) {
      if (file.package() + "." + described.name() != service) continue;
      for (const auto& method : described.method()) methods.insert("/" + service + "/" + method.name());
    }
  }
}

}  // namespace

std::set<std::string> reflect_methods(const Caller& caller) {
  std::set<std::string> methods;
  for (const std::string& entry : texts_of(ask(caller, kListServices, "", kListServicesResponse), 1)) {
    const auto name = texts_of(entry, 1);
    if (!name.empty() && name[0].rfind("grpc.", 0) != 0) add_methods(caller, name[0], methods);
  }
  return methods;
}

}  // namespace lipofill::testing
