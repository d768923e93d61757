#include "server/sessions/shape_desk.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "server/sessions/draining.h"
#include "server/sessions/shortage.h"

namespace lipofill::server {

void ShapeDesk::ask(const std::string& tenant, const std::string& caller, const std::string& drag,
                    ShapeRequest request) {
  const auto found = drag.empty() ? make_lone(tenant, caller, request) : find_or_make(tenant, {caller, drag});
  if (!found.ok()) return request.reply(found.status(), nullptr);
  (*found)->ask(std::move(request));
}

absl::StatusOr<std::shared_ptr<ShapeDrag>> ShapeDesk::make(const std::string& tenant) const {
  auto place = sessions_.reserve(tenant);
  if (!place.ok()) return place.status();
  return std::make_shared<ShapeDrag>(workers_, tenant, *std::move(place));
}

absl::StatusOr<std::shared_ptr<ShapeDrag>> ShapeDesk::make_lone(const std::string& tenant, const std::string& caller,
                                                                ShapeRequest& request) {
  constexpr double kRetryDelayS = 1.0;
  {
    const std::lock_guard lock(mutex_);
    if (is_closed_) return draining();
  }
  const std::lock_guard lock(lone_->mutex);
  const size_t waiting = lone_->of_caller.contains(caller) ? lone_->of_caller[caller] : 0;
  if (waiting >= kMostLone) {
    return shortage("TOO_MANY_SHAPES", kRetryDelayS,
                    absl::StrCat("you wait for ", waiting, " shapes, the bound is ", kMostLone,
                                 "; wait for one of them, or name a drag, of which only the newest is found"));
  }
  auto made = make(tenant);
  if (!made.ok()) return made;
  ++lone_->of_caller[caller];
  request.reply = [lone = lone_, caller, reply = std::move(request.reply)](const absl::Status& status,
                                                                           const FoundTrial* found) {
    {
      const std::lock_guard answered(lone->mutex);
      if (--lone->of_caller[caller] == 0) lone->of_caller.erase(caller);
    }
    reply(status, found);
  };
  return made;
}

absl::StatusOr<std::shared_ptr<ShapeDrag>> ShapeDesk::find_or_make(const std::string& tenant, const Key& key) {
  std::shared_ptr<ShapeDrag> gone;  // let go of outside the lock
  const std::lock_guard lock(mutex_);
  if (is_closed_) return draining();
  if (const auto known = drags_.find(key); known != drags_.end()) return known->second;
  gone = make_way(key.first);
  auto made = make(tenant);
  if (made.ok()) drags_.emplace(key, *made);
  return made;
}

std::shared_ptr<ShapeDrag> ShapeDesk::make_way(const std::string& caller) {
  size_t n = 0;
  auto longest = drags_.end();
  for (auto it = drags_.lower_bound({caller, ""}); it != drags_.end() && it->first.first == caller; ++it, ++n) {
    if (longest == drags_.end() || it->second->idle_time() > longest->second->idle_time()) longest = it;
  }
  if (n < kMostOfCaller) return nullptr;
  auto gone = std::move(longest->second);
  drags_.erase(longest);
  return gone;
}

void ShapeDesk::drop_idle(Clock::duration idle) {
  std::vector<std::shared_ptr<ShapeDrag>> gone;
  const std::lock_guard lock(mutex_);
  for (auto it = drags_.begin(); it != drags_.end();) {
    if (it->second->idle_time() < idle) {
      ++it;
      continue;
    }
    gone.push_back(std::move(it->second));
    it = drags_.erase(it);
  }
}

void ShapeDesk::close() {
  std::map<Key, std::shared_ptr<ShapeDrag>> gone;
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  gone.swap(drags_);
}

size_t ShapeDesk::n_drags() const {
  const std::lock_guard lock(mutex_);
  return drags_.size();
}

}  // namespace lipofill::server
