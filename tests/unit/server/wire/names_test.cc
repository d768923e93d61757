#include "server/wire/names.h"

#include <gtest/gtest.h>

#include "core/base/field_violations.h"

namespace lipofill::server {
namespace {

TEST(Names, ComeApart) {
  EXPECT_EQ(*parse_patient_name("patients/anna-1", "name"), "anna-1");
  const auto scan = parse_scan_name("patients/anna/scans/s1", "name");
  ASSERT_TRUE(scan.ok());
  EXPECT_EQ(scan->patient, "anna");
  EXPECT_EQ(scan->id, "s1");
}

TEST(Names, OfCheckpointsComeApart) {
  const auto checkpoint = parse_checkpoint_name("simulations/x/checkpoints/c-1", "name");
  ASSERT_TRUE(checkpoint.ok()) << checkpoint.status();
  EXPECT_EQ(checkpoint->simulation, "x");
  EXPECT_EQ(checkpoint->id, "c-1");
  for (const char* bad : {"simulations/x", "simulations/x/checkpoints/", "simulations/x/checkpoints/../y",
                          "simulations//checkpoints/c", "patients/x/checkpoints/c"}) {
    EXPECT_FALSE(parse_checkpoint_name(bad, "name").ok()) << bad;
  }
}

TEST(Names, RefuseWhatIsNone) {
  for (const std::string name : {"", "anna", "patients/", "patients/Anna", "patients/1a", "patients/a/b",
                                 "patients/../x", "patients/a/scans/", "models/a", "patients/a\xff"}) {
    const auto parsed = parse_patient_name(name, "parent");
    ASSERT_EQ(field_violations_of(parsed.status()).size(), 1u) << name;
    EXPECT_EQ(field_violations_of(parsed.status())[0].field, "parent");
  }
  EXPECT_FALSE(parse_scan_name("patients/a/models/b", "name").ok());
  EXPECT_FALSE(parse_patient_name("patients/" + std::string(64, 'a'), "name").ok());
  EXPECT_TRUE(parse_patient_name("patients/" + std::string(63, 'a'), "name").ok());
}

TEST(Names, IdsAreMadeUpWhenEmpty) {
  const auto a = id_or_new("", 'p', "patient_id");
  const auto b = id_or_new("", 'p', "patient_id");
  EXPECT_NE(*a, *b);
  EXPECT_TRUE(id_or_new(*a, 'p', "x").ok());
  EXPECT_FALSE(id_or_new("Anna Smith", 'p', "patient_id").ok());
}

TEST(Names, IdsThatATenantChoosesBeginWithItsName) {
  EXPECT_EQ(*id_or_new("ward-a", 'p', "patient_id", "ward"), "ward-a");
  EXPECT_EQ(*id_or_new("a", 'p', "patient_id", "local"), "a");
  EXPECT_TRUE(id_or_new("", 'p', "patient_id", "ward").ok());
  for (const char* bad : {"a", "ward", "ward3-a", "clinic-a"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(id_or_new(bad, 'p', "patient_id", "ward").status())) << bad;
  }
}

TEST(Names, DisplayNamesAndRequestIdsAreShortAndPlain) {
  EXPECT_TRUE(check_display_name("", "display_name").ok());
  EXPECT_TRUE(check_display_name("case-17", "display_name").ok());
  EXPECT_FALSE(check_display_name("Anna Smith", "display_name").ok());
  EXPECT_FALSE(check_display_name(std::string(64, 'a'), "display_name").ok());
  EXPECT_TRUE(check_request_id("6f1d-X").ok());
  EXPECT_FALSE(check_request_id(std::string(65, 'x')).ok());
  EXPECT_FALSE(check_request_id("a\nb").ok());
}

TEST(Pages, TokensGoRound) {
  const auto first = parse_page("patients", 0, "");
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(first->size, 100);
  const auto next = parse_page("patients", 5000, make_page_token("patients", "anna"));
  ASSERT_TRUE(next.ok());
  EXPECT_EQ(next->size, 1000);
  EXPECT_EQ(next->after, "anna");
}

TEST(Pages, RefuseForeignTokensAndNegativeSizes) {
  EXPECT_FALSE(parse_page("patients", -1, "").ok());
  EXPECT_FALSE(parse_page("patients", 1, "???").ok());
  EXPECT_FALSE(parse_page("patients", 1, make_page_token("simulations", "x")).ok());
}

}  // namespace
}  // namespace lipofill::server
