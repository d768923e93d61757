#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/database.h"

namespace lipofill::server {

/// Something that is not what was written.
struct Damage {
  std::string name;  ///< of the resource, or of the file where it is of none
  std::string what;
};

/// The outcome of a walk over a store.
struct Verification {
  uint64_t records = 0;
  uint64_t files = 0;
  uint64_t bytes = 0;  ///< of the files
  std::vector<Damage> damages;

  bool is_whole() const { return damages.empty(); }
};

/// It is called now and then.
using VerificationProgress = std::function<void(const Verification& so_far)>;

/// Looks at every row of a database, whether it is what was written, and at the structure of the
/// database. Rows of a version without sums pass.
absl::Status verify_records(Database& database, Verification& verification, const VerificationProgress& progress);

/// Looks at the file of every complete scan and every checkpoint that the database speaks of, below
/// a directory. Where one is not what it should be, `still_kept`, if any, says whether its record
/// is still there by then: a daemon may have deleted it meanwhile.
using StillKept = std::function<bool(const std::string& path)>;
absl::Status verify_files(Database& database, const std::filesystem::path& root, const StillKept& still_kept,
                          Verification& verification, const VerificationProgress& progress);

/// Walks the whole of a store, whether a daemon serves it or not: records, series and results in
/// the database at `place` (see open_database()), scans and checkpoints in the data directory.
/// FAILED_PRECONDITION where there is no store. Checked by
/// tests/unit/server/store/verification_test.cc and
/// tests/integration/service/silent_damage_test.cc.
absl::StatusOr<Verification> verify_store(const std::filesystem::path& data, const std::string& place,
                                          const VerificationProgress& progress);

}  // namespace lipofill::server
