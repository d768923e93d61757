#include <fstream>

#include "absl/strings/str_cat.h"
#include "server/security/audit_log.h"

namespace lipofill::server {
namespace {

/// Follows the chain through one line after the other.
class AuditReader {
 public:
  explicit AuditReader(const std::optional<AuditHead>& anchor) : anchor_(anchor) {}

  absl::Status read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return absl::InvalidArgumentError(absl::StrCat(path, " cannot be read"));
    uint64_t line_number = 0;
    for (std::string line; std::getline(file, line);) {
      const absl::Status follows = take(line);
      ++line_number;
      if (!follows.ok()) {
        return absl::DataLossError(absl::StrCat(path, " line ", line_number, ": ", std::string(follows.message())));
      }
    }
    return absl::OkStatus();
  }

  const AuditSummary& summary() const { return summary_; }

  /// Tells whether the line that the anchor has was among those read.
  absl::Status check_anchored() const {
    if (!anchor_ || has_anchored_ || anchor_->number == 0) return absl::OkStatus();
    return absl::DataLossError(absl::StrCat("the last line is number ", summary_.head.number,
                                            ", the anchor has number ", anchor_->number, ": the end was cut off"));
  }

 private:
  absl::Status take(const std::string& line) {
    AuditHead told;
    const bool is_whole = read_audit_line(line, told);
    if (!is_whole) {
      ++summary_.torn_lines;
    } else if (!has_begun_) {
      summary_.before = {told.number - 1, told.hash};
    } else if (told.hash != summary_.head.hash) {
      return absl::DataLossError(absl::StrCat("does not carry on from the line before, number ", summary_.head.number,
                                              ": a line was changed, taken out or put in"));
    } else if (told.number != summary_.head.number + 1) {
      return absl::DataLossError(
          absl::StrCat("has the number ", told.number, ", must have ", summary_.head.number + 1));
    }
    if (is_whole) summary_.head.number = told.number;
    summary_.head.hash = hash_of_line(line);
    if (anchor_ && is_whole && told.number == anchor_->number) {
      has_anchored_ = summary_.head.hash == anchor_->hash;
      if (!has_anchored_) {
        return absl::DataLossError(absl::StrCat("is not the line that the anchor has, number ", told.number));
      }
    }
    has_begun_ = true;
    ++summary_.lines;
    return absl::OkStatus();
  }

  const std::optional<AuditHead> anchor_;
  AuditSummary summary_;
  bool has_begun_ = false;
  bool has_anchored_ = false;
};

}  // namespace

absl::StatusOr<AuditSummary> verify_audit(const std::vector<std::string>& files,
                                          const std::optional<AuditHead>& anchor) {
  AuditReader reader(anchor);
  for (const std::string& file : files) {
    if (auto read = reader.read(file); !read.ok()) return read;
  }
  const AuditSummary& summary = reader.summary();
  if (summary.lines > 0 && summary.torn_lines == summary.lines) {
    return absl::DataLossError("there is no line of an audit log in it");
  }
  if (auto anchored = reader.check_anchored(); !anchored.ok()) return anchored;
  return summary;
}

}  // namespace lipofill::server
