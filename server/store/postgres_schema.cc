#include "server/store/postgres_schema.h"

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/substitute.h"
#include "server/store/owner_tables.h"
#include "server/store/postgres_sql.h"
#include "server/store/row_sums.h"
#include "server/store/schema.h"
#include "server/store/schema_tables.h"

namespace lipofill::server {
namespace {

/// Daemons that start together make the schema one after the other. The lock comes before the
/// transaction, which then sees what was made.
constexpr char kLock[] = "SELECT pg_advisory_lock(hashtext('lipofill'), hashtext(current_schema()))";
constexpr char kUnlock[] = "SELECT pg_advisory_unlock(hashtext('lipofill'), hashtext(current_schema()))";

/// Which schema it is; and of every connection the number of its last change, see PostgresDatabase.
/// instr() is SQLite's: the place of bytes within others, from 1; 0 where they are not.
constexpr char kOwnTables[] = R"(
CREATE TABLE lipofill_schema (version BIGINT NOT NULL);
CREATE TABLE last_changes (session TEXT PRIMARY KEY, number BIGINT NOT NULL, since TIMESTAMPTZ NOT NULL)
  WITH (fillfactor = 50);
CREATE FUNCTION instr(BYTEA, BYTEA) RETURNS INTEGER LANGUAGE sql IMMUTABLE STRICT
  AS $$ SELECT position($2 IN $1) $$;
INSERT INTO store VALUES (convert_to(replace(gen_random_uuid()::text, '-', ''), 'UTF8'), 0);
)";

/// A record's sum is made of each column with its kind, and of bytes with their length.
constexpr char kRowParts[] = R"(
CREATE FUNCTION row_part(BYTEA) RETURNS BYTEA LANGUAGE sql IMMUTABLE STRICT
  AS $$ SELECT '\x62'::bytea || int8send(length($1)) || $1 $$;
CREATE FUNCTION row_part(BIGINT) RETURNS BYTEA LANGUAGE sql IMMUTABLE STRICT
  AS $$ SELECT '\x69'::bytea || int8send($1) $$;
CREATE FUNCTION row_part(DOUBLE PRECISION) RETURNS BYTEA LANGUAGE sql IMMUTABLE STRICT
  AS $$ SELECT '\x72'::bytea || float8send($1) $$;
)";

// $0 the types of a table's columns, $1 the parts of its row, of parameters from $2 on.
constexpr char kRowSum[] = R"(
CREATE OR REPLACE FUNCTION row_sum(TEXT, $0) RETURNS BYTEA LANGUAGE sql IMMUTABLE STRICT
  AS $$$$ SELECT sha256(row_part(convert_to($$1, 'UTF8')) || $1) $$$$;
)";

// $0 table, $1 columns, $2 the same of the new row, $3 of the old one.
constexpr char kSumTrigger[] = R"(
ALTER TABLE $0 ADD COLUMN sum BYTEA NOT NULL DEFAULT '\x';
CREATE FUNCTION sum_of_$0() RETURNS TRIGGER LANGUAGE plpgsql AS $$$$
BEGIN
  IF TG_OP = 'UPDATE' AND OLD.sum <> row_sum('$0', $3) THEN
    RAISE EXCEPTION 'a record among $0 is not what was written' USING ERRCODE = 'data_corrupted';
  END IF;
  NEW.sum := row_sum('$0', $2);
  RETURN NEW;
END $$$$;
CREATE TRIGGER $0_are_summed BEFORE INSERT OR UPDATE OF $1 ON $0 FOR EACH ROW EXECUTE FUNCTION sum_of_$0();
)";

/// Files of records that were deleted may go; one whose record is made is no draft any more.
constexpr char kFileTriggers[] = R"(
CREATE FUNCTION file_of_scan() RETURNS TRIGGER LANGUAGE plpgsql AS $$
BEGIN
  INSERT INTO temporary_files VALUES ('scans/'::bytea || OLD.patient || '/'::bytea || OLD.id, 0)
    ON CONFLICT (path) DO UPDATE SET is_draft = 0;
  RETURN NULL;
END $$;
CREATE FUNCTION file_of_checkpoint() RETURNS TRIGGER LANGUAGE plpgsql AS $$
BEGIN
  INSERT INTO temporary_files VALUES ('checkpoints/'::bytea || OLD.simulation || '/'::bytea || OLD.id, 0)
    ON CONFLICT (path) DO UPDATE SET is_draft = 0;
  RETURN NULL;
END $$;
CREATE FUNCTION recorded_checkpoint() RETURNS TRIGGER LANGUAGE plpgsql AS $$
BEGIN
  DELETE FROM temporary_files WHERE path = 'checkpoints/'::bytea || NEW.simulation || '/'::bytea || NEW.id;
  RETURN NULL;
END $$;
CREATE TRIGGER files_of_scans AFTER DELETE ON scans FOR EACH ROW EXECUTE FUNCTION file_of_scan();
CREATE TRIGGER files_of_checkpoints AFTER DELETE ON checkpoints FOR EACH ROW EXECUTE FUNCTION file_of_checkpoint();
CREATE TRIGGER recorded_checkpoints AFTER INSERT ON checkpoints FOR EACH ROW EXECUTE FUNCTION recorded_checkpoint();
)";
constexpr size_t kTriggersOfFiles = 3;

constexpr char kCountTriggers[] =
    "SELECT count(*) FROM pg_trigger t JOIN pg_class c ON c.oid = t.tgrelid "
    "WHERE NOT t.tgisinternal AND t.tgenabled = 'O' AND c.relnamespace = current_schema()::regnamespace";

absl::StatusOr<int64_t> read_number(Database& database, const std::string& sql) {
  Query query(database, sql.c_str());
  const int64_t number = query.next() ? query.integer(0) : 0;
  if (!query.status().ok()) return query.status();
  return number;
}

/// The statement that makes row_sum() for rows of the types that this table has. Equal functions
/// serve tables alike.
absl::StatusOr<std::string> make_row_sum(Database& database, const SummedTable& table) {
  std::vector<std::string> types, parts;
  for (const absl::string_view column : absl::StrSplit(table.columns, ", ")) {
    const std::string sql = absl::StrCat("SELECT format_type(atttypid, NULL) FROM pg_attribute WHERE attrelid = '",
                                         table.name, "'::regclass AND attname = '", column, "'");
    Query type(database, sql.c_str());
    if (!type.next()) return type.status().ok() ? absl::InternalError(sql) : type.status();
    types.push_back(type.text(0));
    parts.push_back(absl::StrCat("row_part($", types.size() + 1, ")"));
  }
  return absl::Substitute(kRowSum, absl::StrJoin(types, ", "), absl::StrJoin(parts, " || "));
}

absl::Status make_sums(PostgresDatabase& database) {
  absl::Status made = database.execute(kRowParts);
  for (const SummedTable& table : kSummedTables) {
    if (!made.ok()) return made;
    const auto row_sum = make_row_sum(database, table);
    if (!row_sum.ok()) return row_sum.status();
    const std::string trigger = absl::Substitute(
        kSumTrigger, table.name, table.columns, with_prefix("NEW.", table.columns), with_prefix("OLD.", table.columns));
    made = database.execute(absl::StrCat(*row_sum, trigger).c_str());
  }
  return made;
}

absl::Status make_schema(PostgresDatabase& database) {
  const std::string tables =
      absl::StrCat(kSchema, kResumeTables, kTenantIndexes, kStoreTables, kPlanTables, kOperationTables);
  absl::Status made = database.execute(to_postgres(tables).c_str());
  made.Update(database.execute(kOwnTables));
  if (made.ok()) made = make_sums(database);
  made.Update(database.execute(kFileTriggers));
  made.Update(database.execute(absl::StrCat("INSERT INTO lipofill_schema VALUES (", kSchemaVersion, ")").c_str()));
  return made;
}

absl::Status check_version(PostgresDatabase& database) {
  const auto version = database.schema_version();
  if (!version.ok()) return version.status();
  if (*version == kSchemaVersion) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat(database.name(), " has schema version ", *version, ", this program knows ", kSchemaVersion));
}

absl::Status check_made(PostgresDatabase& database) {
  if (absl::Status fits = check_version(database); !fits.ok()) return fits;
  for (const SummedTable& table : kSummedTables) {
    Query columns(database, absl::StrCat("SELECT ", table.columns, ", sum FROM ", table.name, " LIMIT 0").c_str());
    if (!columns.run().ok()) return columns.status();
  }
  const auto n_triggers = read_number(database, kCountTriggers);
  if (!n_triggers.ok()) return n_triggers.status();
  const size_t n_made = kTriggersOfFiles + kSummedTables.size();
  if (static_cast<size_t>(*n_triggers) == n_made) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat(database.name(), " is damaged: it has ", *n_triggers, " triggers at work, ",
                                          n_made, " were made. Restore a backup of the database"));
}

/// The number of tables in the schema of the connection, and whether there is a store among them.
struct Tables {
  int64_t all = 0;
  bool has_store = false;
};

absl::StatusOr<Tables> look_for_tables(PostgresDatabase& database) {
  Query query(database,
              "SELECT count(*), coalesce(bool_or(relname = 'lipofill_schema'), false) FROM pg_class "
              "WHERE relkind IN ('r', 'p', 'v', 'm') AND relnamespace = current_schema()::regnamespace");
  if (!query.next()) return query.status();
  return Tables{query.integer(0), query.is_true(1)};
}

absl::Status make_or_check(PostgresDatabase& database) {
  const auto tables = look_for_tables(database);
  if (!tables.ok()) return tables.status();
  if (tables->has_store) return check_made(database);
  if (tables->all == 0) return make_schema(database);
  return absl::FailedPreconditionError(
      absl::StrCat(database.name(), " is a database of another program: its schema has ", tables->all,
                   " tables, and none of a store; name an empty database, or another schema by "
                   "?options=-csearch_path%3Dname"));
}

/// They are made where they are missing: the store may have been made before there were any.
absl::Status make_owner_tables(PostgresDatabase& database) {
  const auto n_there = read_number(database,
                                   "SELECT count(*) FROM pg_class WHERE relname = 'simulation_owners' "
                                   "AND relnamespace = current_schema()::regnamespace");
  if (!n_there.ok() || *n_there > 0) return n_there.status();
  Transaction transaction(database);
  absl::Status made = transaction.status();
  if (made.ok()) made = database.execute(kOwnerTables);
  return made.ok() ? transaction.commit() : made;
}

}  // namespace

absl::Status bring_postgres_up_to_date(PostgresDatabase& database) {
  if (absl::Status locked = database.execute(kLock); !locked.ok()) return locked;
  absl::Status done;
  {
    Transaction transaction(database);
    done = transaction.status();
    if (done.ok()) done = make_or_check(database);
    if (done.ok()) done = transaction.commit();
  }
  if (done.ok()) done = make_owner_tables(database);
  done.Update(database.execute(kUnlock));
  return done.ok() ? database.note_changes() : done;
}

absl::StatusOr<bool> holds_postgres_store(PostgresDatabase& database) {
  const auto tables = look_for_tables(database);
  if (!tables.ok()) return tables.status();
  return tables->has_store;
}

absl::Status check_postgres_schema(PostgresDatabase& database) {
  const auto tables = look_for_tables(database);
  if (!tables.ok()) return tables.status();
  if (tables->has_store) return check_made(database);
  return absl::FailedPreconditionError(absl::StrCat("there is no store in ", database.name()));
}

}  // namespace lipofill::server
