#include "server/wire/message_changes.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "lipofill/v1/plan_service.pb.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

v1::SavedPlan plan(const std::string& text) {
  v1::SavedPlan message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

std::vector<std::string> changes(const std::string& before, const std::string& after, size_t most = 10) {
  std::vector<std::string> lines;
  for (const FieldViolation& change : changes_between(plan(before), plan(after), most)) {
    lines.push_back(absl::StrCat(change.field, ": ", change.description));
  }
  return lines;
}

TEST(MessageChanges, NameEachFieldWithWhatItWasAndIs) {
  EXPECT_THAT(changes("title: 'a'", "title: 'a'"), IsEmpty());
  EXPECT_THAT(changes("title: 'a' side: LEFT_SIDE", "title: 'b' side: RIGHT_SIDE"),
              ElementsAre("title: was \"a\", is \"b\"", "side: was LEFT_SIDE, is RIGHT_SIDE"));
  EXPECT_THAT(changes("content { simulation { injections { volume_ml: 1 } injections { volume_ml: 2 } } }",
                      "content { simulation { injections { volume_ml: 1 } injections { volume_ml: 2.5 } } }"),
              ElementsAre("content.simulation.injections[1].volume_ml: was 2, is 2.5"));
}

TEST(MessageChanges, TellWhatIsNewAndWhatWasTakenOut) {
  EXPECT_THAT(changes("", "title: 'b' content { simulation { injections { zone: 'z' } } }"),
              ElementsAre("title: is new: \"b\"", "content: is new"));
  EXPECT_THAT(changes("content { simulation { injections { zone: 'z' } injections { zone: 'y' } } }",
                      "content { simulation { injections { zone: 'z' } } }"),
              ElementsAre("content.simulation.injections[1]: was taken out"));
}

TEST(MessageChanges, NameEntriesOfMapsByTheirKeys) {
  const auto at = [](const std::string& name, double x) {
    return absl::StrCat("landmarks_mm { key: '", name, "' value { x: ", x, " } } ");
  };
  const auto region = [](const std::string& landmarks) {
    return absl::StrCat("content { model { scan_region { ", landmarks, "} } }");
  };
  EXPECT_THAT(changes(region(at("pronasale", 1)), region(at("pronasale", 2))),
              ElementsAre("content.model.scan_region.landmarks_mm[pronasale].x: was 1, is 2"));
  EXPECT_THAT(changes(region(at("nasion", 1)), region(at("nasion", 1) + at("pronasale", 2))),
              ElementsAre("content.model.scan_region.landmarks_mm[pronasale]: is new"));
}

TEST(MessageChanges, AreAsManyAsAreWantedAndShort) {
  EXPECT_EQ(changes("", "title: 'a' side: LEFT_SIDE scan: 's'", 2).size(), 2u);
  const auto lines = changes("", absl::StrCat("title: '", std::string(500, 'a'), "'"));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_LT(lines[0].size(), 100u);
}

}  // namespace
}  // namespace lipofill::server
