#include "server/ops/logging.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "server/ops/log_formatters.h"

namespace lipofill::server {
namespace {

using ::testing::MatchesRegex;

class LoggingTest : public ::testing::Test {
 protected:
  std::string line(std::unique_ptr<spdlog::formatter> formatter, const std::string& message) {
    std::ostringstream out;
    spdlog::logger logger("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(out));
    logger.set_formatter(std::move(formatter));
    logger.warn("{}", message);
    return out.str();
  }
};

TEST_F(LoggingTest, TextHasTimeLevelMessageAndFields) {
  const LogScope outer(LogFields{{"request_id", "r1"}});
  const LogScope inner(LogFields{{"code", "OK"}, {"duration_ms", 1.25}});
  EXPECT_THAT(line(make_text_formatter(), "call"),
              MatchesRegex("....-..-..T..:..:..[.]...Z warning call request_id=r1 code=OK duration_ms=1.25\n"));
}

TEST_F(LoggingTest, JsonIsOneObjectALineWhateverTheMessage) {
  const LogScope scope(LogFields{{"code", "OK"}, {"duration_ms", 1.25}});
  const std::string text = line(make_json_formatter(), "a \"quote\"\nand \xff no UTF-8");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  const auto object = nlohmann::json::parse(text);
  EXPECT_EQ(object["level"], "warning");
  EXPECT_EQ(object["message"], "a \"quote\"\nand \xEF\xBF\xBD no UTF-8");
  EXPECT_EQ(object["code"], "OK");
  EXPECT_EQ(object["duration_ms"], 1.25);
  EXPECT_THAT(object["time"].get<std::string>(), MatchesRegex("....-..-..T..:..:..[.]...Z"));
}

TEST_F(LoggingTest, FieldsAreThoseOfTheThreadAndOfTheScope) {
  {
    const LogScope scope(LogFields{{"request_id", "r1"}});
    std::thread([this] {
      EXPECT_THAT(line(make_text_formatter(), "other"), MatchesRegex(".* warning other\n"));
    }).join();
  }
  EXPECT_THAT(line(make_text_formatter(), "after"), MatchesRegex(".* warning after\n"));
}

}  // namespace
}  // namespace lipofill::server
