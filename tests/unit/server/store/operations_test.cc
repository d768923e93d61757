// Long-running operations in the store: what is there after the end of a daemon, in either kind of
// database.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "server/store/sql_store.h"
#include "server/store/verification.h"
#include "tests/unit/server/store/store_kinds.h"

namespace lipofill::server {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class OperationsInStoreTest : public ::testing::TestWithParam<StoreKind> {
 protected:
  OperationsInStoreTest() {
    reopen();
    EXPECT_TRUE(store_->create_patient({"anna", "", {}, 1}, {}).ok());
  }
  void reopen() {
    store_ = nullptr;
    auto store = SqlStore::open(place_);
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
  }
  static OperationRecord operation(const std::string& id, int64_t create_time_us = 1) {
    return {id, "anna", "clinic", "MakeForecast", "r-1", "f", std::string("a\0b", 3), false, "", create_time_us};
  }
  /// "(none)" where it is not there.
  std::string part(const std::string& id, int number) {
    const auto found = store_->get_operation_part(id, number);
    EXPECT_TRUE(found.ok()) << found.status();
    return found->value_or("(none)");
  }

  lipofill::testing::TemporaryDirectory directory_;
  const std::string place_ = make_place(GetParam(), directory_);
  std::unique_ptr<SqlStore> store_;
};

TEST_P(OperationsInStoreTest, AreThereWithTheirPartsUntilTheyAreDone) {
  ASSERT_TRUE(store_->create_operation(operation("o1")).ok());
  const std::string bytes("\0\xff part", 7);
  ASSERT_TRUE(store_->keep_operation_part("o1", 0, "first").ok());
  ASSERT_TRUE(store_->keep_operation_part("o1", 0, bytes).ok());
  ASSERT_TRUE(store_->keep_operation_part("o1", 7, "last").ok());
  reopen();
  const auto listed = store_->list_operations();
  ASSERT_TRUE(listed.ok()) << listed.status();
  ASSERT_THAT(*listed, SizeIs(1));
  const OperationRecord& found = listed->front();
  EXPECT_EQ(found.id, "o1");
  EXPECT_EQ(found.patient, "anna");
  EXPECT_EQ(found.tenant, "clinic");
  EXPECT_EQ(found.method, "MakeForecast");
  EXPECT_EQ(found.request_id, "r-1");
  EXPECT_EQ(found.fingerprint, "f");
  EXPECT_EQ(found.request_message, std::string("a\0b", 3));
  EXPECT_FALSE(found.done);
  EXPECT_EQ(part("o1", 0), bytes);
  EXPECT_EQ(part("o1", 1), "(none)");
  EXPECT_EQ(part("o1", 7), "last");
  ASSERT_TRUE(store_->finish_operation("o1", "response").ok());
  EXPECT_EQ(part("o1", 0), "(none)");
  EXPECT_TRUE(store_->list_operations()->front().done);
  EXPECT_EQ(store_->list_operations()->front().response_message, "response");
  EXPECT_TRUE(absl::IsNotFound(store_->keep_operation_part("o1", 8, "late")));
  ASSERT_TRUE(store_->forget_operation("o1").ok());
  EXPECT_THAT(*store_->list_operations(), SizeIs(1)) << "it is done: nobody cancels it any more";
}

TEST_P(OperationsInStoreTest, GoWithTheirPatientOrWhenTheyAreCancelled) {
  EXPECT_TRUE(absl::IsNotFound(store_->create_operation({"o0", "berta"})));
  for (const char* id : {"o1", "o2"}) {
    ASSERT_TRUE(store_->create_operation(operation(id)).ok());
    ASSERT_TRUE(store_->keep_operation_part(id, 0, "bytes").ok());
  }
  ASSERT_TRUE(store_->forget_operation("o1").ok());
  EXPECT_EQ(part("o1", 0), "(none)");
  ASSERT_THAT(*store_->list_operations(), SizeIs(1));
  ASSERT_TRUE(store_->delete_patient("anna", true).ok());
  EXPECT_THAT(*store_->list_operations(), IsEmpty());
  EXPECT_EQ(part("o2", 0), "(none)");
  EXPECT_TRUE(store_->finish_operation("o2", "response").ok()) << "nobody is left to tell";
  EXPECT_THAT(*store_->list_operations(), IsEmpty());
}

TEST_P(OperationsInStoreTest, TheNewestThatAreDoneAreKept) {
  for (int k = 0; k < kMaxDoneOperations + 3; ++k) {
    ASSERT_TRUE(store_->create_operation(operation(absl::StrCat("o", k), 100 + k)).ok());
    if (k > 0) ASSERT_TRUE(store_->finish_operation(absl::StrCat("o", k), "response").ok());
  }
  const auto listed = store_->list_operations();
  ASSERT_THAT(*listed, SizeIs(kMaxDoneOperations + 1));
  EXPECT_EQ((*listed)[0].id, "o0") << "it is under way";
  EXPECT_EQ((*listed)[1].id, "o3");
}

INSTANTIATE_TEST_SUITE_P(Kinds, OperationsInStoreTest, ::testing::Values(StoreKind::kSqlite, StoreKind::kPostgres),
                         kind_name);

/// Work is done again where its part rotted, and an operation that rotted is not begun.
TEST(DamagedOperations, AreNotReadAndAreFound) {
  lipofill::testing::TemporaryDirectory directory;
  const auto store = SqlStore::open(directory.file("lipofill.sqlite"));
  ASSERT_TRUE(store.ok());
  ASSERT_TRUE((*store)->create_patient({"anna", "", {}, 1}, {}).ok());
  for (const char* id : {"o1", "o2"}) {
    ASSERT_TRUE((*store)->create_operation({id, "anna"}).ok());
    ASSERT_TRUE((*store)->keep_operation_part(id, 0, "bytes").ok());
  }
  auto& database = const_cast<Database&>((*store)->database());
  const char rot[] =
      "DROP TRIGGER operations_are_checked; DROP TRIGGER operations_are_summed_anew; "
      "DROP TRIGGER operation_parts_are_checked; DROP TRIGGER operation_parts_are_summed_anew; "
      "UPDATE operations SET request = x'00' WHERE id = CAST('o1' AS BLOB); "
      "UPDATE operation_parts SET bytes = x'00' WHERE operation = CAST('o2' AS BLOB)";
  ASSERT_TRUE(database.execute(rot).ok());
  ASSERT_THAT(*(*store)->list_operations(), SizeIs(1));
  EXPECT_EQ((*store)->list_operations()->front().id, "o2");
  EXPECT_FALSE((*store)->get_operation_part("o2", 0)->has_value());
  Verification verification;
  ASSERT_TRUE(verify_records(database, verification, [](const Verification&) {}).ok());
  std::vector<std::string> names;
  for (const auto& damage : verification.damages) names.push_back(damage.name);
  EXPECT_THAT(names, ::testing::IsSupersetOf({"operations/o1", "operations/o2 (its part 0)"}));
}

}  // namespace
}  // namespace lipofill::server
