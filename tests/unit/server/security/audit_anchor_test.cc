#include "server/security/audit_anchor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "server/security/audit_log.h"
#include "tests/unit/server/security/key_fixture.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using lipofill::testing::SigningKey;
using ::testing::HasSubstr;

class AuditAnchorTest : public ::testing::Test {
 protected:
  std::shared_ptr<const AnchorKey> key(const SigningKey& signing) {
    std::ofstream(directory_.file("key")) << signing.private_pem();
    auto opened = AnchorKey::open(directory_.file("key"));
    EXPECT_TRUE(opened.ok()) << opened.status();
    return std::make_shared<const AnchorKey>(*std::move(opened));
  }
  /// Writes so many durable lines, and some after them that are not.
  void write(int durable, int others = 0, std::shared_ptr<const AnchorKey> with = nullptr, uint64_t rotate = 1 << 20) {
    const auto log = AuditLog::open(path_, rotate, std::move(with));
    ASSERT_TRUE(log.ok()) << log.status();
    for (int i = 0; i < durable; ++i) ASSERT_TRUE((*log)->append_durably(entry()).ok());
    for (int i = 0; i < others; ++i) ASSERT_TRUE((*log)->append(entry()).ok());
  }
  static AuditEntry entry() { return {"s", "ward", "planner", "/p.S/M", {}, "", "OK", "r"}; }
  std::string text(const std::string& path) const {
    std::stringstream content;
    content << std::ifstream(path).rdbuf();
    return content.str();
  }
  /// Leaves so many lines of the log.
  void cut_to(int lines) {
    std::istringstream all(text(path_));
    std::string kept;
    std::string line;
    for (int i = 0; i < lines && std::getline(all, line); ++i) kept += line + "\n";
    std::ofstream(path_) << kept;
  }
  std::string refusal(std::shared_ptr<const AnchorKey> with = nullptr) {
    const auto log = AuditLog::open(path_, 1 << 20, std::move(with));
    EXPECT_TRUE(log.ok() || absl::IsDataLoss(log.status())) << log.status();
    return log.ok() ? "" : std::string(log.status().message());
  }

  lipofill::testing::TemporaryDirectory directory_;
  const std::string path_ = directory_.file("audit.jsonl");
  const std::string anchor_ = AuditAnchor::path_of(path_);
};

TEST_F(AuditAnchorTest, AnEndThatIsCutOffIsNoticed) {
  write(5);
  EXPECT_EQ(refusal(), "");
  cut_to(4);
  EXPECT_THAT(refusal(), HasSubstr("ends with line 4, but its anchor has line 5: its end was cut off"));
  EXPECT_THAT(std::string(verify_audit({path_}, *read_anchor(anchor_, nullptr)).status().message()),
              HasSubstr("the anchor has number 5: the end was cut off"));
  cut_to(0);
  EXPECT_THAT(refusal(), HasSubstr("its end was cut off"));
}

TEST_F(AuditAnchorTest, AnotherLastLineIsNoticed) {
  write(3);
  std::string log = text(path_);
  log.replace(log.rfind("\"OK\""), 4, "\"NO\"");
  std::ofstream(path_) << log;
  EXPECT_THAT(refusal(), HasSubstr("is not the one that its anchor has"));
  EXPECT_TRUE(absl::IsDataLoss(verify_audit({path_}, *read_anchor(anchor_, nullptr)).status()));
}

TEST_F(AuditAnchorTest, IsNeverAheadOfTheMedium) {
  write(2);
  const auto log = AuditLog::open(path_, 1 << 20);
  ASSERT_TRUE((*log)->append(entry()).ok());
  EXPECT_EQ((*read_anchor(anchor_, nullptr))->number, 2u) << "a loss of power may take the third";
  ASSERT_TRUE((*log)->append_durably(entry()).ok());
  EXPECT_EQ((*read_anchor(anchor_, nullptr))->number, 4u);
}

TEST_F(AuditAnchorTest, GoesOnOverFilesAndStarts) {
  write(30, 3, nullptr, 2000);
  write(5, 1);
  EXPECT_EQ(refusal(), "");
  EXPECT_EQ((*read_anchor(anchor_, nullptr))->number, 39u);
}

TEST_F(AuditAnchorTest, OneSlotIsEnough) {
  write(4);
  std::string both = text(anchor_);
  for (const size_t torn : {size_t{10}, size_t{1034}}) {
    std::string one = both;
    one.replace(torn, 100, std::string(100, '#'));
    std::ofstream(anchor_) << one;
    const auto head = read_anchor(anchor_, nullptr);
    ASSERT_TRUE(head.ok() && *head) << head.status();
    EXPECT_GE((*head)->number, 3u);
  }
  std::ofstream(anchor_) << std::string(2048, '#');
  EXPECT_THAT(refusal(), HasSubstr("is no anchor of an audit log, or is damaged"));
}

TEST_F(AuditAnchorTest, ASignedOneCannotBeWrittenByAnother) {
  for (const SigningKey& signing : {SigningKey::ed25519(), SigningKey::p256(), SigningKey::rsa()}) {
    std::filesystem::remove(path_);
    std::filesystem::remove(anchor_);
    const auto own = key(signing);
    write(5, 0, own);
    EXPECT_EQ(refusal(own), "");
    cut_to(3);
    std::filesystem::remove(anchor_);
    EXPECT_EQ(refusal(nullptr), "") << "who has no key begins a new anchor";
    EXPECT_THAT(refusal(own), HasSubstr("not signed with audit-key-file"));
    const auto another = key(SigningKey::ed25519());
    EXPECT_THAT(refusal(another), HasSubstr("not signed with audit-key-file"));
  }
}

TEST_F(AuditAnchorTest, KeysThatCannotSignAreRefused) {
  std::ofstream(directory_.file("public")) << SigningKey::ed25519().public_pem();
  EXPECT_THAT(std::string(AnchorKey::open(directory_.file("public")).status().message()),
              HasSubstr("has no private key"));
  EXPECT_TRUE(AnchorKey::open_to_verify(directory_.file("public")).ok());
  EXPECT_FALSE(AnchorKey::open(directory_.file("none")).ok());
}

}  // namespace
}  // namespace lipofill::server
