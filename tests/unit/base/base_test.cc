#include <gtest/gtest.h>

#include <limits>

#include "core/base/error_hints.h"
#include "core/base/field_violations.h"
#include "core/base/hash.h"
#include "core/base/unwanted.h"

namespace lipofill {
namespace {

TEST(FieldViolations, CarryFieldValueAndBound) {
  FieldViolations violations;
  violations.check_range("time.step_ms", 0.0, 0.001, 10.0, "ms");
  violations.check_half_open("poisson_ratio", 0.5, 0.0, 0.5, "");
  violations.check_range("fine", 5.0, 5.0, 5.0, "mm");
  violations.check_range("nan", std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0, "mm");
  const absl::Status status = violations.to_status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  const auto found = field_violations_of(status);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].field, "time.step_ms");
  EXPECT_EQ(found[0].description, "is 0 ms, must be in [0.001, 10]");
  EXPECT_EQ(found[1].field, "poisson_ratio");
  EXPECT_EQ(found[2].field, "nan");
  EXPECT_NE(std::string(status.message()).find("time.step_ms: is 0 ms"), std::string::npos);
}

TEST(FieldViolations, AbsorbPutsThemBelowAPrefix) {
  FieldViolations violations;
  violations.absorb("films[1]", field_violation("n_xi", "is 0"));
  violations.absorb("films[2]", field_violation("", "is odd"));
  violations.absorb("scan", absl::NotFoundError("gone"));
  violations.absorb("well", absl::OkStatus());
  const auto all = violations.all();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].field, "films[1].n_xi");
  EXPECT_EQ(all[1].field, "films[2]");
  EXPECT_EQ(all[2].description, "gone");
}

TEST(FieldViolations, NothingWrongIsOk) {
  EXPECT_TRUE(FieldViolations().to_status().ok());
  EXPECT_TRUE(field_violations_of(absl::InternalError("other")).empty());
}

TEST(ErrorHints, TravelWithAStatus) {
  const absl::Status status = with_hints(absl::UnavailableError("later"), {"DRAINING", 0.25});
  EXPECT_EQ(status.message(), "later");
  ASSERT_TRUE(hints_of(status));
  EXPECT_EQ(hints_of(status)->reason, "DRAINING");
  EXPECT_EQ(hints_of(status)->retry_delay_s, 0.25);
  EXPECT_EQ(hints_of(with_hints(absl::InternalError(""), {"BROKEN", std::nullopt}))->retry_delay_s, std::nullopt);
  EXPECT_FALSE(hints_of(absl::UnavailableError("later")));
  EXPECT_TRUE(with_hints(absl::OkStatus(), {"FINE", 1.0}).ok());
}

TEST(Unwanted, IsCancelled) {
  EXPECT_TRUE(check_wanted(nullptr).ok());
  EXPECT_TRUE(check_wanted([] { return false; }).ok());
  EXPECT_TRUE(absl::IsCancelled(check_wanted([] { return true; })));
}

TEST(Hasher, GivesTheDigestsOfFips180) {
  Hasher empty;
  EXPECT_EQ(empty.hex_digest(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  Hasher abc;
  abc.add_bytes("abc", 3);
  EXPECT_EQ(abc.hex_digest(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Hasher, TellsWhereOneValueEndsAndTheNextBegins) {
  Hasher a, b;
  a.add("ab");
  a.add("c");
  b.add("a");
  b.add("bc");
  EXPECT_NE(a.hex_digest(), b.hex_digest());
}

}  // namespace
}  // namespace lipofill
