#include "absl/strings/str_cat.h"
#include "server/store/row_sums.h"
#include "server/store/sql_store.h"

namespace lipofill::server {
namespace {

#define OPERATION_IS_WHOLE IS_WHOLE("operations", OPERATION_COLUMNS)
#define PART_IS_WHOLE IS_WHOLE("operation_parts", OPERATION_PART_COLUMNS)

OperationRecord operation_of(const Query& row) {
  OperationRecord operation;
  operation.id = row.text(0);
  operation.patient = row.text(1);
  operation.tenant = row.text(2);
  operation.method = row.text(3);
  operation.request_id = row.text(4);
  operation.fingerprint = row.text(5);
  operation.request_message = row.text(6);
  operation.done = row.is_true(7);
  operation.response_message = row.text(8);
  operation.create_time_us = row.integer(9);
  return operation;
}

absl::Status erase_parts(Database& database, const std::string& id) {
  Query parts(database, "DELETE FROM operation_parts WHERE operation = ?");
  return parts.bind(id).run();
}

}  // namespace

absl::Status SqlStore::create_operation(const OperationRecord& operation) {
  return turns_.transact([&]() -> absl::Status {
    if (const auto patient = read_patient(operation.patient); !patient.ok()) return patient.status();
    Query insert(*database_, "INSERT INTO operations (" OPERATION_COLUMNS ") VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    return insert
        .bind(operation.id, operation.patient, operation.tenant, operation.method, operation.request_id,
              operation.fingerprint, operation.request_message, operation.done, operation.response_message,
              operation.create_time_us)
        .run();
  });
}

absl::StatusOr<std::vector<OperationRecord>> SqlStore::list_operations() {
  return turns_.look([&]() -> absl::StatusOr<std::vector<OperationRecord>> {
    Query query(*database_,
                "SELECT " OPERATION_COLUMNS ", " OPERATION_IS_WHOLE " FROM operations ORDER BY create_time_us, id");
    std::vector<OperationRecord> operations;
    while (query.next()) {
      if (query.is_true(10)) operations.push_back(operation_of(query));
    }
    if (!query.status().ok()) return query.status();
    return operations;
  });
}

absl::Status SqlStore::keep_operation_part(const std::string& id, int number, const std::string& bytes) {
  return turns_.transact([&]() -> absl::Status {
    Query present(*database_, "SELECT 1 FROM operations WHERE id = ? AND done = 0");
    if (!present.bind(id).next()) {
      return present.status().ok() ? absl::NotFoundError(absl::StrCat("there is no operations/", id, " under way"))
                                   : present.status();
    }
    Query earlier(*database_, "DELETE FROM operation_parts WHERE operation = ? AND number = ?");
    if (absl::Status erased = earlier.bind(id, number).run(); !erased.ok()) return erased;
    Query insert(*database_, "INSERT INTO operation_parts (" OPERATION_PART_COLUMNS ") VALUES (?, ?, ?)");
    return insert.bind(id, number, bytes).run();
  });
}

absl::StatusOr<std::optional<std::string>> SqlStore::get_operation_part(const std::string& id, int number) {
  return turns_.look([&]() -> absl::StatusOr<std::optional<std::string>> {
    Query query(*database_, "SELECT bytes, " PART_IS_WHOLE " FROM operation_parts WHERE operation = ? AND number = ?");
    if (query.bind(id, number).next() && query.is_true(1)) return query.text(0);
    if (!query.status().ok()) return query.status();
    return std::nullopt;
  });
}

absl::Status SqlStore::finish_operation(const std::string& id, const std::string& response_message) {
  return turns_.transact([&]() -> absl::Status {
    Query update(*database_, "UPDATE operations SET done = 1, response = ? WHERE id = ?");
    absl::Status done = update.bind(response_message, id).run();
    if (done.ok()) done = erase_parts(*database_, id);
    if (!done.ok()) return done;
    Query prune(*database_, R"(
        DELETE FROM operations WHERE done = 1 AND id NOT IN (
          SELECT id FROM operations WHERE done = 1 ORDER BY create_time_us DESC, id DESC LIMIT ?))");
    return prune.bind(kMaxDoneOperations).run();
  });
}

absl::Status SqlStore::forget_operation(const std::string& id) {
  return turns_.transact([&]() -> absl::Status {
    Query query(*database_, "DELETE FROM operations WHERE id = ? AND done = 0");
    return query.bind(id).run();
  });
}

}  // namespace lipofill::server
