// Every bit of every row counts: what was flipped is an error, never an answer.

#include "server/store/row_sums.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <set>

#include "absl/strings/str_cat.h"
#include "server/store/sqlite_database.h"
#include "server/store/verification.h"
#include "tests/unit/server/store/full_store.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

/// What a store answers, a line each; errors are answers too.
class Answers {
 public:
  explicit Answers(Store& store) {
    const auto patient = store.get_patient("anna");
    add(patient.ok() ? absl::StrCat(patient->display_name, patient->labels.size(), patient->labels.count("side")) : "",
        patient.status());
    const auto scan = store.get_scan("anna", "scan-1");
    add(scan.ok() ? absl::StrCat(scan->sha256, scan->size_bytes, scan->complete) : "", scan.status());
    const auto model = store.get_model("anna", "model-1");
    add(model.ok() ? model->spec_message + model->scan + model->content_hash : "", model.status());
    const auto simulation = store.get_simulation("sim-1");
    add(simulation.ok() ? absl::StrCat(simulation->spec_message, simulation->model, state_name(simulation->state)) : "",
        simulation.status());
    const auto checkpoint = store.get_checkpoint("sim-1", "kept-1");
    add(checkpoint.ok() ? absl::StrCat(checkpoint->step, checkpoint->time_s, checkpoint->sha256) : "",
        checkpoint.status());
    const auto commands = store.list_commands("sim-1");
    add(commands.ok() && !commands->empty() ? absl::StrCat(commands->front().step, commands->front().payload) : "",
        commands.status());
    const auto series = store.next_series_chunk("sim-1", 0);
    add(series.ok() && series->has_value() ? absl::StrCat((**series).rows_message, (**series).last_step) : "",
        series.status());
    const auto result = store.get_result("sim-1");
    add(result.ok() ? result->meshes_message + result->frame_message : "", result.status());
    const auto owner = store.owner_of_simulation("sim-1");
    add(owner.ok() ? owner->tenant + owner->patient : "", owner.status());
    const auto plan = store.get_plan("anna", "plan-1");
    add(plan.ok() ? absl::StrCat(plan->revision, plan->scan, plan->target, plan->content_message) : "", plan.status());
    const auto revision = store.get_plan_revision("anna", "plan-1", 1);
    add(revision.ok() ? revision->content_message + revision->changes_message : "", revision.status());
    const auto runs = store.list_plan_runs("anna", "plan-1");
    add(runs.ok() && !runs->empty() ? runs->front().simulation + runs->front().content_hash : "", runs.status());
    const auto operations = store.list_operations();
    add(operations.ok() && !operations->empty() ? operations->front().method + operations->front().request_message : "",
        operations.status());
    const auto part = store.get_operation_part("op-1", 3);
    add(part.ok() ? part->value_or("") : "", part.status());
    const auto request = store.find_request({"Create", "r1", "f"});
    add(request.ok() && request->has_value() ? **request : "", request.status());
  }
  /// Whether every answer is one of the others, an error, or nothing.
  bool are_true(const Answers& others) const {
    for (size_t i = 0; i < lines_.size(); ++i) {
      if (!lines_[i].empty() && lines_[i] != others.lines_[i]) return false;
    }
    return true;
  }
  bool operator==(const Answers& other) const { return lines_ == other.lines_; }
  std::string text() const {
    std::string text;
    for (const std::string& line : lines_) absl::StrAppend(&text, line, "\n");
    return text;
  }

 private:
  void add(const std::string& line, const absl::Status& status) { lines_.push_back(status.ok() ? line : ""); }
  std::vector<std::string> lines_;
};

class RowSumsTest : public ::testing::Test {
 protected:
  RowSumsTest() { make_full_store(data_); }
  std::string path() const { return (data_ / "lipofill.sqlite").string(); }
  /// Changes a row behind the store's back: its sum stays, and so do the triggers.
  void tamper(const std::string& table, const std::string& statement) {
    const auto database = SqliteDatabase::open(path());
    std::vector<std::string> triggers;
    Query query(**database,
                "SELECT name, sql FROM sqlite_master WHERE type = 'trigger' AND CAST(tbl_name AS BLOB) = ? AND "
                "name NOT LIKE '%are_summed'");
    query.bind(table);
    std::string drops;
    for (; query.next(); triggers.push_back(query.text(1)))
      absl::StrAppend(&drops, "DROP TRIGGER ", query.text(0), ";");
    query.run().IgnoreError();
    ASSERT_TRUE((*database)->execute(drops.c_str()).ok());
    ASSERT_TRUE((*database)->execute(statement.c_str()).ok());
    for (const std::string& trigger : triggers) ASSERT_TRUE((*database)->execute(trigger.c_str()).ok());
  }

  lipofill::testing::TemporaryDirectory directory_;
  const std::filesystem::path data_ = directory_.path() / "data";
};

TEST_F(RowSumsTest, EveryRowIsSummedAndEveryColumnBut) {
  const auto database = SqliteDatabase::open(path());
  for (const SummedTable& table : kSummedTables) {
    Query rows(**database, absl::StrCat("SELECT count(*), sum(length(sum)) FROM ", table.name).c_str());
    ASSERT_TRUE(rows.next());
    EXPECT_GE(rows.integer(0), 1) << table.name;
    EXPECT_EQ(rows.integer(1), 32 * rows.integer(0)) << table.name;
    Query names(**database, absl::StrCat("SELECT name FROM pragma_table_info('", table.name, "')").c_str());
    while (names.next()) {
      if (names.text(0) == "sum") continue;
      EXPECT_THAT(absl::StrCat(", ", table.columns, ","), HasSubstr(absl::StrCat(" ", names.text(0), ",")));
    }
  }
  // Whatever table comes later is summed, or is named here.
  Query tables(**database, "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%'");
  ASSERT_TRUE(tables.next());
  EXPECT_EQ(tables.integer(0), static_cast<int64_t>(kSummedTables.size()) + 2) << "besides store and temporary_files";
}

TEST_F(RowSumsTest, AnyColumnThatWasChangedIsDamageWithItsName) {
  const std::unique_ptr<Store> before = *SqlStore::open(path());
  for (const SummedTable& table : kSummedTables) {
    const auto database = SqliteDatabase::open(path());
    Query names(**database,
                absl::StrCat("SELECT name FROM pragma_table_info('", table.name, "') WHERE pk = 0").c_str());
    std::vector<std::string> columns;
    while (names.next()) columns.push_back(names.text(0));
    for (const std::string& column : columns) {
      if (column == "sum") continue;
      const std::string copy = directory_.file("copy");
      std::filesystem::remove(copy);
      ASSERT_TRUE((*database)->copy_to(copy).ok());
      const auto copied = SqliteDatabase::open(copy);
      const std::string change =
          absl::StrCat("DROP TRIGGER ", table.name, "_are_checked; DROP TRIGGER ", table.name,
                       "_are_summed_anew; UPDATE ", table.name, " SET ", column, " = CASE typeof(", column,
                       ") WHEN 'blob' THEN CAST(", column, " || 'x' AS BLOB) ELSE ", column, " + 1 END");
      ASSERT_TRUE((*copied)->execute("PRAGMA foreign_keys = OFF").ok());
      ASSERT_TRUE((*copied)->execute(change.c_str()).ok()) << change;
      Verification found;
      ASSERT_TRUE(verify_records(**copied, found, [](const Verification&) {}).ok());
      EXPECT_EQ(found.damages.size(), 1u) << table.name << "." << column;
    }
  }
}

TEST_F(RowSumsTest, ADamagedRowIsNamedWhenItIsReadAndTheRestServes) {
  tamper("models", "UPDATE models SET spec = CAST('the lundmarks of a model' AS BLOB)");
  const auto store = SqlStore::open(path());
  const auto damaged = (*store)->get_model("anna", "model-1");
  EXPECT_TRUE(absl::IsDataLoss(damaged.status())) << damaged.status();
  EXPECT_THAT(std::string(damaged.status().message()), HasSubstr("patients/anna/models/model-1 is damaged"));
  const auto listed = (*store)->list_models("anna", {});
  ASSERT_EQ(listed->size(), 1u);
  EXPECT_TRUE(listed->front().is_damaged);
  EXPECT_TRUE((*store)->get_patient("anna").ok());
  EXPECT_TRUE((*store)->get_scan("anna", "scan-1").ok());
  EXPECT_TRUE((*store)->delete_model("anna", "model-1").ok()) << "it can go";
}

TEST_F(RowSumsTest, DamageIsNeverSummedAnew) {
  const auto database = SqliteDatabase::open(path());
  ASSERT_TRUE((*database)->execute("UPDATE simulations SET sum = zeroblob(32)").ok());
  const auto store = SqlStore::open(path());
  EXPECT_TRUE(absl::IsDataLoss((*store)->set_simulation_state("sim-1", SimulationState::kFailed, "x")));
  EXPECT_TRUE(absl::IsDataLoss((*store)->get_simulation("sim-1").status()));
}

TEST_F(RowSumsTest, AnIndexThatRottedIsMadeAgain) {
  {
    std::fstream file(path(), std::ios::in | std::ios::out | std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(file)), {});
    // The id of the simulation stands in its table once, and in indexes.
    const size_t first = bytes.find("\x06sim-1");
    ASSERT_EQ(first, std::string::npos);
    int changed = 0;
    for (size_t at = bytes.find("localsim-1"); at != std::string::npos; at = bytes.find("localsim-1", at + 1)) {
      file.clear();
      file.seekp(static_cast<std::streamoff>(at + 9));
      file.put('3');
      ++changed;
    }
    ASSERT_EQ(changed, 1) << "the index by tenant";
  }
  const auto store = SqlStore::open(path());
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_EQ((*store)->list_simulations({}, {})->size(), 1u);
}

// At seeded places all over the file; the structure of the database included.
TEST_F(RowSumsTest, NoFlippedBitOfTheDatabaseIsServedAsTruth) {
  constexpr int kFlips = 1500;
  const Answers expected(**SqlStore::open(path()));
  std::ifstream in(path(), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  std::mt19937_64 random(7);
  const std::string copy_data = directory_.file("copy");
  std::filesystem::create_directories(copy_data);
  const std::string copy = copy_data + "/lipofill.sqlite";
  int refused = 0, erred = 0;
  for (int flip = 0; flip < kFlips;) {
    const size_t at = random() % whole.size();
    if (whole[at] == '\0') continue;  // most of the file is not in use
    ++flip;
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (random() % 8)));
    std::ofstream(copy, std::ios::binary | std::ios::trunc)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    auto store = SqlStore::open(copy);
    if (!store.ok()) {
      ++refused;
      continue;
    }
    const Answers answers(**store);
    ASSERT_TRUE(answers.are_true(expected)) << "byte " << at << ":\n" << answers.text();
    if (answers == expected) continue;
    ++erred;
    Verification found;
    ASSERT_TRUE(verify_records(**SqliteDatabase::open(copy), found, [](const Verification&) {}).ok());
    ASSERT_FALSE(found.is_whole()) << "byte " << at << " is missed:\n" << answers.text();
  }
  std::cout << kFlips << " flips: " << refused << " refused at the start, " << erred
            << " are errors of what they hit\n";
  EXPECT_GT(erred, 50);
}

}  // namespace
}  // namespace lipofill::server
