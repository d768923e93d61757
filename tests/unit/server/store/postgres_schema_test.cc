// The schema in a real PostgreSQL: who makes it, what it refuses, and its sums.

#include "server/store/postgres_schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "server/store/database_opening.h"
#include "server/store/row_sums.h"
#include "server/store/verification.h"
#include "tests/unit/server/store/full_store.h"
#include "tests/unit/server/store/store_kinds.h"

namespace lipofill::server {
namespace {

using lipofill::testing::PostgresServer;
using ::testing::HasSubstr;

/// Expressions that change a column, and that make it again what it was.
std::pair<std::string, std::string> change_and_back(const std::string& column) {
  constexpr char kNumbers[] =
      " create_time_us format unit size_bytes received_bytes complete state epoch first_step step on_course kind "
      "last_command revision update_time_us number done ";
  if (column == "time_s") return {"7", "0.07"};
  if (column == "wall_s") return {"7", "0"};
  if (absl::StrContains(kNumbers, absl::StrCat(" ", column, " "))) return {column + " + 1", column + " - 1"};
  return {column + " || '\\x00'::bytea", absl::StrCat("substr(", column, ", 1, length(", column, ") - 1)")};
}

class PostgresSchemaTest : public ::testing::Test {
 protected:
  absl::Status open_status() { return SqlStore::open(place_).status(); }
  Verification look() {
    auto found = verify_store(data_, place_, [](const Verification&) {});
    EXPECT_TRUE(found.ok()) << found.status();
    return found.ok() ? *std::move(found) : Verification();
  }
  Verification look_at_records() {
    const auto database = open_database_to_look(place_);
    EXPECT_TRUE(database.ok()) << database.status();
    Verification found;
    EXPECT_TRUE(verify_records(**database, found, [](const Verification&) {}).ok());
    return found;
  }
  void change(const std::string& table, const std::string& statement) {
    PostgresServer::execute(place_, absl::StrCat("ALTER TABLE ", table, " DISABLE TRIGGER ALL; ", statement,
                                                 "; ALTER TABLE ", table, " ENABLE TRIGGER ALL"));
  }

  lipofill::testing::TemporaryDirectory directory_;
  const std::filesystem::path data_ = directory_.path() / "data";
  const std::string place_ = make_place(StoreKind::kPostgres, directory_);
};

TEST_F(PostgresSchemaTest, ManyThatStartTogetherMakeOneStore) {
  std::vector<std::string> ids(6);
  std::vector<std::thread> threads;
  for (std::string& id : ids) {
    threads.emplace_back([this, &id] {
      const auto store = SqlStore::open(place_);
      ASSERT_TRUE(store.ok()) << store.status();
      id = (*store)->read_identity()->id;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(ids.front().size(), 32u);
  for (const std::string& id : ids) EXPECT_EQ(id, ids.front());
}

TEST_F(PostgresSchemaTest, RefusesTheTablesOfAnotherProgramAndOtherVersions) {
  PostgresServer::execute(place_, "CREATE TABLE theirs (x INTEGER)");
  EXPECT_TRUE(absl::IsFailedPrecondition(open_status())) << open_status();
  EXPECT_THAT(std::string(open_status().message()), HasSubstr("is a database of another program"));
  PostgresServer::execute(place_, "DROP TABLE theirs");
  ASSERT_TRUE(open_status().ok());
  PostgresServer::execute(place_, "UPDATE lipofill_schema SET version = 99");
  EXPECT_TRUE(absl::IsFailedPrecondition(open_status())) << open_status();
  EXPECT_THAT(std::string(open_status().message()), HasSubstr("schema version 99"));
}

TEST_F(PostgresSchemaTest, MissesATriggerThatIsOff) {
  ASSERT_TRUE(open_status().ok());
  PostgresServer::execute(place_, "ALTER TABLE scans DISABLE TRIGGER scans_are_summed");
  EXPECT_TRUE(absl::IsDataLoss(open_status())) << open_status();
  EXPECT_THAT(std::string(open_status().message()), HasSubstr("triggers at work"));
}

TEST_F(PostgresSchemaTest, SaysThatThereIsNoSchema) {
  const std::string elsewhere = place_ + "x";
  const absl::Status status = SqlStore::open(elsewhere).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(status)) << status;
  const auto looked = verify_store(data_, elsewhere, [](const Verification&) {});
  EXPECT_THAT(std::string(looked.status().message()), HasSubstr("there is no store in"));
}

TEST_F(PostgresSchemaTest, AWholeStoreIsWholeAndAnyChangedColumnIsDamageWithItsName) {
  make_full_store(data_, place_);
  EXPECT_TRUE(look().is_whole());
  EXPECT_EQ(look().records, 15u) << "one of each table";
  EXPECT_EQ(look().files, 2u);
  for (const SummedTable& table : kSummedTables) {
    for (const absl::string_view column : absl::StrSplit(table.columns, ", ")) {
      // Keys are left: others refer to them.
      const std::vector<std::string> keys = absl::StrSplit(table.key, ", ");
      if (std::find(keys.begin(), keys.end(), column) != keys.end()) continue;
      const std::string name(column);
      const auto set = [&](const std::string& value) {
        change(table.name, absl::StrCat("UPDATE ", table.name, " SET ", name, " = ", value));
      };
      const auto [changed, restored] = change_and_back(name);
      set(changed);
      EXPECT_EQ(look_at_records().damages.size(), 1u) << table.name << "." << name;
      set(restored);
    }
  }
  EXPECT_TRUE(look_at_records().is_whole());
}

TEST_F(PostgresSchemaTest, ADamagedRowIsAnErrorOfItsOwnAndIsNeverSummedAnew) {
  const auto store = make_full_store(data_, place_);
  change("models", "UPDATE models SET spec = 'the lundmarks of a model'");
  change("simulations", "UPDATE simulations SET reason = 'x'");
  EXPECT_TRUE(absl::IsDataLoss(store->get_model("anna", "model-1").status()));
  EXPECT_TRUE(store->list_models("anna", {})->front().is_damaged);
  EXPECT_TRUE(store->get_scan("anna", "scan-1").ok());
  EXPECT_TRUE(absl::IsDataLoss(store->set_simulation_state("sim-1", SimulationState::kFailed, "x")));
  EXPECT_TRUE(absl::IsDataLoss(store->get_simulation("sim-1").status()));
  EXPECT_THAT(look().damages.front().name, HasSubstr("patients/anna/models/model-1"));
  EXPECT_TRUE(store->delete_model("anna", "model-1").ok()) << "it can go";
}

}  // namespace
}  // namespace lipofill::server
