#include "server/sessions/pending_series.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "spdlog/spdlog.h"

namespace lipofill::server {

void PendingSeries::add(SeriesEntry row) {
  size_t n_rows = 0;
  {
    const std::lock_guard lock(mutex_);
    rows_.push_back(std::move(row));
    n_rows = rows_.size();
  }
  if (n_rows % kChunk != 0) return;
  const absl::Status kept = flush();
  if (kept.ok()) return;
  spdlog::error("simulations/{}: {} rows of its series {}: {}", simulation_, n_rows,
                n_rows < kMost ? "wait" : "are lost", kept.ToString());
  if (n_rows >= kMost) forget(n_rows);
}

std::vector<SeriesEntry> PendingSeries::after(uint64_t step) const {
  const std::lock_guard lock(mutex_);
  std::vector<SeriesEntry> later;
  std::copy_if(rows_.begin(), rows_.end(), std::back_inserter(later),
               [step](const SeriesEntry& row) { return row.report.step > step; });
  return later;
}

absl::Status PendingSeries::flush() {
  const std::vector<SeriesEntry> rows = after(0);
  if (rows.empty()) return absl::OkStatus();
  if (const absl::Status kept = sink_.append_series(simulation_, rows); !kept.ok()) return kept;
  forget(rows.size());
  return absl::OkStatus();
}

void PendingSeries::forget(size_t n_rows) {
  const std::lock_guard lock(mutex_);
  rows_.erase(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(n_rows));
}

}  // namespace lipofill::server
