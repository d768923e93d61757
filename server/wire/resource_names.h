#pragma once

#include <google/protobuf/message.h>

#include <set>
#include <string>

namespace lipofill::server {

/// The resources that a message names anywhere, in fields of any depth.
struct ResourceNames {
  std::set<std::string> patients;     ///< ids
  std::set<std::string> simulations;  ///< ids
  std::set<std::string> operations;   ///< ids
  std::set<std::string> whole;        ///< names in full, "patients/a/scans/s"

  size_t size() const { return patients.size() + simulations.size() + operations.size(); }
};

/// Every text that begins as the name of a resource does counts, whatever field it is in: a new
/// field, or a new method, is covered before anybody thinks of it. What is no proper name is left
/// to the method, which refuses it.
/// Checked by tests/unit/server/wire/resource_names_test.cc.
ResourceNames resource_names_in(const google::protobuf::Message& message);

}  // namespace lipofill::server
