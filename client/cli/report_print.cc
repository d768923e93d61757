#include "client/cli/report_print.h"

#include <unistd.h>

#include <string>
#include <system_error>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/process.h"
#include "client/cpp/json_file.h"

namespace lipofill::client {
namespace {

constexpr const char* kBrowsers[] = {"chromium", "chromium-browser", "google-chrome-stable", "google-chrome"};

std::filesystem::path find_browser() {
  for (const char* name : kBrowsers) {
    if (std::filesystem::path found = find_program(name); !found.empty()) return found;
  }
  return {};
}

std::string address_of(const std::filesystem::path& file) {
  std::string address = "file://";
  for (const char c : std::filesystem::absolute(file).string()) {
    const bool is_plain =
        absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '/' || c == '.' || c == '-' || c == '_';
    if (is_plain) {
      address += c;
    } else {
      absl::StrAppendFormat(&address, "%%%02X", static_cast<unsigned char>(c));
    }
  }
  return address;
}

}  // namespace

absl::Status print_html(const std::filesystem::path& html, const std::filesystem::path& pdf) {
  const std::filesystem::path browser = find_browser();
  if (browser.empty()) {
    return absl::FailedPreconditionError(
        "printing needs Chromium: 'apt-get install chromium', or open the HTML in any browser and print it");
  }
  const TemporaryFolder folder;
  std::vector<std::string> command = {browser.string(),
                                      "--headless",
                                      "--disable-gpu",
                                      "--no-first-run",
                                      "--no-pdf-header-footer",
                                      "--generate-pdf-document-outline",
                                      absl::StrCat("--user-data-dir=", (folder.path() / "profile").string()),
                                      absl::StrCat("--print-to-pdf=", std::filesystem::absolute(pdf).string())};
  // Chromium's sandbox refuses to run as root; the page is this program's own and has no script.
  if (::geteuid() == 0) command.emplace_back("--no-sandbox");
  command.push_back(address_of(html));
  std::error_code error;
  std::filesystem::remove(pdf, error);
  const std::filesystem::path log = folder.path() / "log";
  const auto code = run_process(command, log);
  if (!code.ok()) return code.status();
  if (*code == 0 && std::filesystem::exists(pdf, error)) return absl::OkStatus();
  return absl::InternalError(absl::StrCat(browser.filename().string(), " did not print (exit code ", *code,
                                          "): ", read_text_file(log).value_or("")));
}

}  // namespace lipofill::client
