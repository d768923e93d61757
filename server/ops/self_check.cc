#include "server/ops/self_check.h"

#include <string>

#include "spdlog/spdlog.h"

namespace lipofill::server {

SelfCheck::SelfCheck(std::chrono::duration<double> period, std::function<absl::Status()> check,
                     std::function<void(bool)> change)
    : check_(std::move(check)), change_(std::move(change)), periodic_("self-check", period, [this] { look(); }) {}

void SelfCheck::look() {
  const absl::Status reached = check_();
  if (reached.ok() == is_good_) return;
  is_good_ = reached.ok();
  if (reached.ok()) {
    spdlog::info("the daemon can be reached again");
  } else {
    spdlog::error("the daemon cannot be reached: {}; health says NOT_SERVING", std::string(reached.message()));
  }
  change_(reached.ok());
}

}  // namespace lipofill::server
