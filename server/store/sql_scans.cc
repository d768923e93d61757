#include "absl/strings/str_cat.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "server/store/sql_store.h"

namespace lipofill::server {
namespace {

ScanRecord scan_of(const Query& row) {
  ScanRecord scan;
  scan.patient = row.text(0);
  scan.id = row.text(1);
  scan.format = static_cast<int>(row.integer(2));
  scan.unit = static_cast<int>(row.integer(3));
  scan.size_bytes = row.unsigned_integer(4);
  scan.sha256 = row.text(5);
  scan.received_bytes = row.unsigned_integer(6);
  scan.complete = row.integer(7) != 0;
  scan.report_message = row.text(8);
  scan.create_time_us = row.integer(9);
  return scan;
}

/// A row of a list: one that is damaged is named and no more.
ScanRecord listed_scan_of(const Query& row) {
  if (row.is_true(10)) return scan_of(row);
  ScanRecord damaged;
  damaged.patient = row.text(0);
  damaged.id = row.text(1);
  damaged.is_damaged = true;
  return damaged;
}

absl::Status no_scan(const std::string& patient, const std::string& id) {
  return absl::NotFoundError(absl::StrCat("there is no ", scan_name(patient, id)));
}

}  // namespace

absl::StatusOr<ScanRecord> SqlStore::create_scan(const ScanRecord& scan, const RequestKey& request) {
  const auto earlier = transact_once(request, scan_name(scan.patient, scan.id), [&] { return write_scan(scan); });
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return get_scan(scan.patient, (**earlier).substr(scan_name(scan.patient, "").size()));
  return scan;
}

absl::Status SqlStore::write_scan(const ScanRecord& scan) {
  if (const auto patient = read_patient(scan.patient); !patient.ok()) return patient.status();
  Query insert(*database_, "INSERT INTO scans (" SCAN_COLUMNS ") VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  const absl::Status done = insert
                                .bind(scan.patient, scan.id, scan.format, scan.unit, scan.size_bytes, scan.sha256,
                                      scan.received_bytes, scan.complete, scan.report_message, scan.create_time_us)
                                .run();
  if (!absl::IsAlreadyExists(done)) return done;
  return absl::AlreadyExistsError(absl::StrCat(scan_name(scan.patient, scan.id), " exists"));
}

absl::StatusOr<ScanRecord> SqlStore::get_scan(const std::string& patient, const std::string& id) {
  return turns_.look([&] { return read_scan(patient, id); });
}

absl::StatusOr<ScanRecord> SqlStore::read_scan(const std::string& patient, const std::string& id) {
  Query query(*database_,
              "SELECT " SCAN_COLUMNS ", " IS_WHOLE("scans", SCAN_COLUMNS) " FROM scans WHERE patient = ? AND id = ?");
  if (!query.bind(patient, id).next()) return query.status().ok() ? no_scan(patient, id) : query.status();
  if (!query.is_true(10)) return damaged_record(scan_name(patient, id));
  return scan_of(query);
}

absl::StatusOr<std::vector<ScanRecord>> SqlStore::list_scans(const std::string& patient, const Page& page) {
  return turns_.look([&]() -> absl::StatusOr<std::vector<ScanRecord>> {
    if (const auto known = read_patient(patient); !known.ok()) return known.status();
    Query query(*database_, "SELECT " SCAN_COLUMNS ", " IS_WHOLE(
                                "scans", SCAN_COLUMNS) " FROM scans WHERE patient = ? AND id > ? ORDER BY id LIMIT ?");
    query.bind(patient, page.after, page.size);
    std::vector<ScanRecord> scans;
    while (query.next()) scans.push_back(listed_scan_of(query));
    if (!query.status().ok()) return query.status();
    return scans;
  });
}

absl::StatusOr<std::vector<ScanRecord>> SqlStore::list_incomplete_scans() {
  return turns_.look([&]() -> absl::StatusOr<std::vector<ScanRecord>> {
    // One that is damaged is not among them: nobody can tell whether it is complete.
    Query query(*database_, "SELECT " SCAN_COLUMNS " FROM scans WHERE complete = 0 AND " IS_WHOLE(
                                "scans", SCAN_COLUMNS) " ORDER BY patient, id");
    std::vector<ScanRecord> scans;
    while (query.next()) scans.push_back(scan_of(query));
    if (!query.status().ok()) return query.status();
    return scans;
  });
}

absl::Status SqlStore::set_scan_received(const std::string& patient, const std::string& id, uint64_t bytes) {
  return turns_.transact([&] {
    Query update(*database_, "UPDATE scans SET received_bytes = ? WHERE patient = ? AND id = ?");
    const absl::Status done = update.bind(bytes, patient, id).run();
    return done.ok() && database_->changes() == 0 ? no_scan(patient, id) : done;
  });
}

absl::Status SqlStore::complete_scan(const std::string& patient, const std::string& id,
                                     const std::string& report_message) {
  return turns_.transact([&] {
    Query update(*database_, "UPDATE scans SET complete = 1, report = ? WHERE patient = ? AND id = ?");
    const absl::Status done = update.bind(report_message, patient, id).run();
    return done.ok() && database_->changes() == 0 ? no_scan(patient, id) : done;
  });
}

absl::Status SqlStore::delete_scan(const std::string& patient, const std::string& id) {
  return turns_.transact([&]() -> absl::Status {
    Query count(*database_,
                "SELECT id FROM models WHERE patient = ? AND (scan = ? OR bone_scan = ?) ORDER BY id LIMIT 1");
    if (count.bind(patient, id, id).next()) {
      return absl::FailedPreconditionError(
          absl::StrCat(model_name(patient, count.text(0)), " was built from ", scan_name(patient, id)));
    }
    Query plans(*database_, "SELECT id FROM plans WHERE patient = ? AND (scan = ? OR target = ?) ORDER BY id LIMIT 1");
    if (plans.bind(patient, id, id).next()) {
      return absl::FailedPreconditionError(
          absl::StrCat(plan_name(patient, plans.text(0)), " is for ", scan_name(patient, id)));
    }
    Query remove(*database_, "DELETE FROM scans WHERE patient = ? AND id = ?");
    const absl::Status removed = remove.bind(patient, id).run();
    if (removed.ok() && database_->changes() == 0) return no_scan(patient, id);
    return removed.ok() ? forget_requests(scan_name(patient, id)) : removed;
  });
}

}  // namespace lipofill::server
