#include "server/ops/logging.h"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "server/ops/log_formatters.h"

namespace lipofill::server {
namespace {

thread_local std::vector<const LogFields*> scopes_of_thread;

constexpr char kTime[] = "%Y-%m-%dT%H:%M:%S.%eZ";

void append(spdlog::memory_buf_t& line, std::string_view text) {
  line.append(text.data(), text.data() + text.size());
}

/// Formats a line by a pattern, without an end of line.
std::unique_ptr<spdlog::pattern_formatter> make_pattern(const std::string& pattern) {
  return std::make_unique<spdlog::pattern_formatter>(pattern, spdlog::pattern_time_type::utc, "");
}

class TextFormatter : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    pattern_->format(message, line);
    for (const LogFields* fields : scopes_of_thread) {
      for (const LogField& field : *fields) {
        append(line, " " + field.name + "=");
        const auto* text = std::get_if<std::string>(&field.value);
        append(line, text != nullptr ? *text : fmt::format("{:.6g}", std::get<double>(field.value)));
      }
    }
    append(line, "\n");
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return make_text_formatter(); }

 private:
  std::unique_ptr<spdlog::pattern_formatter> pattern_ = make_pattern(std::string(kTime) + " %l %v");
};

class JsonFormatter : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    spdlog::memory_buf_t time;
    time_->format(message, time);
    const auto level = spdlog::level::to_string_view(message.level);
    nlohmann::ordered_json object = {{"time", std::string(time.data(), time.size())},
                                     {"level", std::string(level.data(), level.size())},
                                     {"message", std::string(message.payload.data(), message.payload.size())}};
    for (const LogFields* fields : scopes_of_thread) {
      for (const LogField& field : *fields) {
        std::visit([&](const auto& value) { object[field.name] = value; }, field.value);
      }
    }
    // Bytes that are no UTF-8 become replacement characters: a line is always JSON.
    append(line, object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return make_json_formatter(); }

 private:
  std::unique_ptr<spdlog::pattern_formatter> time_ = make_pattern(kTime);
};

}  // namespace

std::unique_ptr<spdlog::formatter> make_text_formatter() {
  return std::make_unique<TextFormatter>();
}

std::unique_ptr<spdlog::formatter> make_json_formatter() {
  return std::make_unique<JsonFormatter>();
}

void set_up_logging(const std::string& level, const std::string& format) {
  auto logger = spdlog::stderr_logger_mt("lipofilld");
  logger->set_formatter(format == "json" ? make_json_formatter() : make_text_formatter());
  logger->set_level(spdlog::level::from_str(level));
  logger->flush_on(spdlog::level::trace);
  spdlog::set_default_logger(std::move(logger));
}

LogScope::LogScope(LogFields fields) : fields_(std::move(fields)) {
  scopes_of_thread.push_back(&fields_);
}

LogScope::~LogScope() {
  scopes_of_thread.pop_back();
}

}  // namespace lipofill::server
