#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/security/principal.h"

namespace lipofill::server {

/// The holder of certificates of one name.
struct CertificateEntry {
  bool is_alternative = false;  ///< a subject alternative name, not the common name
  std::string name;
  Principal principal;
};

/// Maps client certificates to their holders. Checked by
/// tests/unit/server/security/certificate_map_test.cc.
class CertificateMap {
 public:
  /// JSON: {"certificates": [{"common_name": "planner-3", "tenant": "ward3", "roles": ["planner"]},
  /// ...]}; in place of "common_name" "alternative_name", one of the certificate's subject
  /// alternative names (DNS name, URI, e-mail or IP address); "patients" as in tokens.
  /// INVALID_ARGUMENT naming the entry and what is wrong with it.
  static absl::StatusOr<CertificateMap> parse(const std::string& text);

  /// Returns the holder of a certificate with these names; nullptr for none. If several entries
  /// fit, it is the first.
  const Principal* find(const std::vector<std::string>& common_names,
                        const std::vector<std::string>& alternative_names) const;

 private:
  std::vector<CertificateEntry> entries_;
};

}  // namespace lipofill::server
