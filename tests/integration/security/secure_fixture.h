#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "lipofill/v1/frame_service.grpc.pb.h"
#include "lipofill/v1/operation_service.pb.h"
#include "lipofill/v1/patient_service.pb.h"
#include "lipofill/v1/plan_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "tests/integration/security/caller.h"
#include "tests/integration/service/daemon_process.h"
#include "tests/unit/server/security/key_fixture.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::testing {

std::string read_whole_file(const std::string& path);

/// A daemon that asks who calls, on loopback: by tokens of a key of the test's own.
class SecureTest : public ::testing::Test {
 protected:
  /// `arguments` beside those for tokens.
  explicit SecureTest(const std::vector<std::string>& arguments = {});

  void start(const std::vector<std::string>& arguments);
  /// Somebody of a tenant with a role; of certain patients only where these are named.
  Caller caller(const std::string& tenant, const std::string& role, const std::vector<std::string>& patients = {});
  Caller bearer(const std::string& token) const { return {channel_, token}; }
  std::string token(const nlohmann::json& claims) const { return key_.token(claims); }
  /// Claims that a token of this test is good with.
  static nlohmann::json claims(const std::string& tenant, const std::string& role);
  std::string audit_file() const { return directory_.file("data") + "/audit.jsonl"; }

  TemporaryDirectory directory_;
  const SigningKey key_ = SigningKey::p256();
  std::vector<std::string> arguments_;
  std::unique_ptr<DaemonProcess> daemon_;
  std::shared_ptr<grpc::Channel> channel_;
};

/// Makes a patient with a scan, a model, a plan, a simulation and a checkpoint; all names begin
/// with the tenant's.
class Possessions {
 public:
  explicit Possessions(const Caller& owner, const std::string& tenant);

  std::string patient;
  std::string scan;
  std::string model;
  std::string operation;
  std::string plan;
  std::string simulation;
  std::string checkpoint;
};

}  // namespace lipofill::testing
