#include "server/security/audit_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "server/security/audit_anchor.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

constexpr uint64_t kLarge = 1 << 20;

class AuditLogTest : public ::testing::Test {
 protected:
  std::unique_ptr<AuditLog> open(uint64_t rotate_bytes = kLarge) {
    auto log = AuditLog::open(path_, rotate_bytes);
    EXPECT_TRUE(log.ok()) << log.status();
    return *std::move(log);
  }
  static AuditEntry entry(const std::string& subject) {
    return {subject, "ward", "planner", "/p.S/M", {"patients/ward-a"}, "", "OK", "r1"};
  }
  void write(int n) {
    const auto log = open();
    for (int i = 0; i < n; ++i) ASSERT_TRUE(log->append(entry(absl::StrCat("s", i))).ok());
  }
  std::vector<std::string> lines() {
    std::ifstream file(path_);
    std::vector<std::string> all;
    for (std::string line; std::getline(file, line);) all.push_back(line);
    return all;
  }
  void put(const std::vector<std::string>& lines) { std::ofstream(path_) << absl::StrJoin(lines, "\n") << "\n"; }
  std::string complaint() {
    const auto summary = verify_audit({path_});
    EXPECT_TRUE(summary.ok() || absl::IsDataLoss(summary.status()));
    return summary.ok() ? "" : std::string(summary.status().message());
  }

  lipofill::testing::TemporaryDirectory directory_;
  const std::string path_ = directory_.file("audit.jsonl");
};

TEST_F(AuditLogTest, SaysWhoDidWhatAndGoesOnWhereItWas) {
  write(2);
  const AuditHead head = open()->head();
  EXPECT_EQ(head.number, 2u);
  {
    const auto log = open();
    AuditEntry strange = entry("M\xfcller \"x\"\n");
    strange.made = "patients/ward-b";
    ASSERT_TRUE(log->append_durably(strange).ok());
  }
  ASSERT_EQ(lines().size(), 3u);
  const auto line = nlohmann::json::parse(lines()[2]);
  EXPECT_EQ(line["number"], 3);
  EXPECT_EQ(line["previous"], head.hash);
  EXPECT_EQ(line["subject"], "M\xef\xbf\xbdller \"x\"\n") << "one line whatever is in it";
  EXPECT_EQ(line["tenant"], "ward");
  EXPECT_EQ(line["role"], "planner");
  EXPECT_EQ(line["method"], "/p.S/M");
  EXPECT_EQ(line["resources"][0], "patients/ward-a");
  EXPECT_EQ(line["made"], "patients/ward-b");
  EXPECT_EQ(line["outcome"], "OK");
  EXPECT_EQ(line["request_id"], "r1");
  EXPECT_THAT(line["time"].get<std::string>(), ::testing::MatchesRegex("2[0-9-]*T[0-9:]*\\.[0-9]*Z"));
  const auto summary = verify_audit({path_});
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(summary->lines, 3u);
  EXPECT_EQ(summary->before.number, 0u);
  EXPECT_EQ(summary->head.hash, open()->head().hash);
  using std::filesystem::perms;
  EXPECT_EQ(std::filesystem::status(path_).permissions(), perms::owner_read | perms::owner_write);
}

TEST_F(AuditLogTest, ShowsEveryLineThatWasChangedTakenOutOrPutIn) {
  write(6);
  const std::vector<std::string> whole = lines();
  EXPECT_EQ(complaint(), "");
  for (size_t i = 0; i + 1 < whole.size(); ++i) {
    std::vector<std::string> changed = whole;
    changed[i].replace(changed[i].find("ward-a"), 6, "ward-z");
    put(changed);
    EXPECT_THAT(complaint(), HasSubstr(absl::StrCat("line ", i + 2))) << "changed " << i;
  }
  for (size_t i = 1; i + 1 < whole.size(); ++i) {
    std::vector<std::string> fewer = whole;
    fewer.erase(fewer.begin() + static_cast<long>(i));
    put(fewer);
    EXPECT_THAT(complaint(), HasSubstr("taken out")) << "without " << i;
    std::vector<std::string> more = whole;
    more.insert(more.begin() + static_cast<long>(i), whole[0]);
    put(more);
    EXPECT_NE(complaint(), "") << "one more at " << i;
    more[i] = "not JSON";
    put(more);
    EXPECT_NE(complaint(), "") << "rubbish at " << i;
  }
  std::vector<std::string> swapped = whole;
  std::swap(swapped[2], swapped[3]);
  put(swapped);
  EXPECT_NE(complaint(), "");
}

TEST_F(AuditLogTest, TheEndIsComparedWithAHeadKeptElsewhere) {
  write(4);
  const AuditHead head = open()->head();
  std::vector<std::string> fewer = lines();
  fewer.pop_back();
  put(fewer);
  const auto summary = verify_audit({path_});
  ASSERT_TRUE(summary.ok());
  EXPECT_NE(summary->head.hash, head.hash);
  EXPECT_EQ(summary->head.number, 3u);
}

TEST_F(AuditLogTest, GoesOnAfterALineCutShortByALossOfPower) {
  write(2);
  // A line that power was lost under is not on the medium, so the anchor does not know it.
  const std::string anchor = AuditAnchor::path_of(path_);
  std::filesystem::copy_file(anchor, anchor + ".before");
  write(1);
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 20);
  std::filesystem::rename(anchor + ".before", anchor);
  write(2);
  EXPECT_EQ(lines().size(), 5u);
  const auto summary = verify_audit({path_});
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(summary->torn_lines, 1u);
  EXPECT_EQ(summary->head.number, 4u);
  std::vector<std::string> changed = lines();
  changed[2][5] = '#';
  put(changed);
  EXPECT_NE(complaint(), "") << "what is left of it is in the chain too";
}

TEST_F(AuditLogTest, GoesOnInANewFileAndDeletesNothing) {
  {
    const auto log = open(1500);
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(log->append_durably(entry("s")).ok());
  }
  std::set<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(path_).parent_path())) {
    if (file.path().extension() != ".anchor") files.insert(file.path().string());
    EXPECT_LT(file.file_size(), 2100u);
  }
  ASSERT_GT(files.size(), 2u);
  std::vector<std::string> ordered(files.begin(), files.end());
  ordered.erase(ordered.begin());  // the present one comes last
  ordered.push_back(path_);
  const auto summary = verify_audit(ordered);
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(summary->lines, 20u);
  std::swap(ordered[0], ordered[1]);
  EXPECT_TRUE(absl::IsDataLoss(verify_audit(ordered).status()));
  std::filesystem::remove(path_);
  std::filesystem::remove(AuditAnchor::path_of(path_));
  EXPECT_GT(open()->head().number, 10u) << "after an end between two files it goes on from the last one kept";
}

TEST_F(AuditLogTest, HasOneWriterAndRefusesWhatIsNoLog) {
  const auto log = open();
  EXPECT_TRUE(absl::IsFailedPrecondition(AuditLog::open(path_, kLarge).status()));
  EXPECT_FALSE(AuditLog::open(directory_.file("no/such/folder"), kLarge).ok());
  EXPECT_FALSE(AuditLog::open(directory_.file(""), kLarge).ok());
  std::ofstream(directory_.file("other")) << "dear diary\n";
  EXPECT_TRUE(absl::IsDataLoss(AuditLog::open(directory_.file("other"), kLarge).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(verify_audit({directory_.file("none")}).status()));
  EXPECT_TRUE(absl::IsDataLoss(verify_audit({directory_.file("other")}).status()));
}

TEST_F(AuditLogTest, SaysSoWhenThereIsNoRoomAndGoesOnWhenThereIs) {
  ::signal(SIGXFSZ, SIG_IGN);
  const auto log = open();
  ASSERT_TRUE(log->append(entry("s")).ok());
  const auto size = std::filesystem::file_size(path_);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  for (const size_t room : {0, 1, 100}) {
    const rlimit full{size + room, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
    const absl::Status refused = log->append_durably(entry("s"));
    ::setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
  }
  ASSERT_TRUE(log->append_durably(entry("after")).ok());
  ASSERT_TRUE(log->append(entry("later")).ok());
  EXPECT_EQ(complaint(), "");
  EXPECT_EQ(verify_audit({path_})->head.hash, log->head().hash);
  EXPECT_EQ(log->head().number, 3u);
}

TEST_F(AuditLogTest, LinesOfManyThreadsAreOneChain) {
  const auto log = open(4000);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&log] {
      for (int i = 0; i < 50; ++i)
        EXPECT_TRUE((i % 5 == 0 ? log->append_durably(entry("s")) : log->append(entry("s"))).ok());
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(log->head().number, 200u);
  EXPECT_EQ(complaint(), "");
}

}  // namespace
}  // namespace lipofill::server
