#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/grpcpp.h>

#include <memory>
#include <string>
#include <vector>

namespace lipofill::testing {

/// How a call ended, and what came before.
struct Answer {
  grpc::Status status;
  std::vector<std::string> messages;  ///< serialised

  grpc::StatusCode code() const { return status.error_code(); }
  /// Of its ErrorInfo; empty without one.
  std::string reason() const;
};

/// Somebody who calls methods by their names, "PatientService/GetPatient" for
/// "/lipofill.v1.PatientService/GetPatient".
class Caller {
 public:
  /// Without a token where it is empty.
  Caller(std::shared_ptr<grpc::Channel> channel, std::string token)
      : channel_(std::move(channel)), token_(std::move(token)) {}

  /// One message, whether the method streams or not; all answers of a stream.
  Answer call(const std::string& method, const google::protobuf::Message& request) const;
  /// The same with a request in JSON, of the type that the method takes.
  Answer call_json(const std::string& method, const std::string& request) const;
  Answer call_bytes(const std::string& method, const std::string& request) const;

  /// A context with the token.
  std::unique_ptr<grpc::ClientContext> context() const;
  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

 private:
  std::shared_ptr<grpc::Channel> channel_;
  std::string token_;
};

/// The full name of a method, "/lipofill.v1.PatientService/GetPatient"; names that begin with '/'
/// are that already.
std::string full_name(const std::string& method);

}  // namespace lipofill::testing
