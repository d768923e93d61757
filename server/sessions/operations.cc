#include "server/sessions/operations.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "server/sessions/draining.h"
#include "server/sessions/identifiers.h"
#include "server/sessions/thread_name.h"

namespace lipofill::server {
namespace {

constexpr size_t kMaxDone = 1000;
constexpr char kPatients[] = "patients/";

Owner owner_of_view(const OperationView& view) {
  return {view.tenant, std::string(absl::StripPrefix(view.target, kPatients))};
}

absl::Status no_operation(const std::string& id) {
  return absl::NotFoundError(
      absl::StrCat("there is no operations/", id, "; operations do not outlive the daemon, the models they made do"));
}

}  // namespace

Operations::Operations() : timer_([this] { serve_timeouts(); }) {}

Operations::~Operations() {
  stop();
  timer_.join();
}

Operations::Entry* Operations::find_request(const RequestKey& request) {
  if (request.id.empty()) return nullptr;
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&request](const auto& entry) {
    const RequestKey& known = entry.second.request;
    return known.tenant == request.tenant && known.method == request.method && known.id == request.id;
  });
  return found == entries_.end() ? nullptr : &found->second;
}

Operations::Entry& Operations::add(const std::string& target, const RequestKey& request) {
  OperationView view;
  view.id = make_id('o');
  view.target = target;
  view.tenant = request.tenant;
  view.stage = "waiting";
  view.create_time_us = now_us();
  return entries_[view.id] = Entry{view, request, false};
}

absl::StatusOr<Operations::Started> Operations::start(const std::string& target, const RequestKey& request) {
  const std::lock_guard lock(mutex_);
  if (stopping_) return draining();
  if (const Entry* known = find_request(request); known != nullptr) {
    if (known->request.fingerprint == request.fingerprint) return Started{known->view, false};
    return absl::InvalidArgumentError(
        absl::StrCat("request_id ", request.id, " was used for another ", request.method, " request"));
  }
  return Started{add(target, request).view, true};
}

OperationView Operations::add_done(const std::string& target, const RequestKey& request, std::string response_message) {
  const std::lock_guard lock(mutex_);
  if (const Entry* known = find_request(request); known != nullptr) return known->view;
  Entry& entry = add(target, request);
  entry.view.done = true;
  entry.view.progress = 1.0;
  entry.view.stage = "done";
  entry.view.response_message = std::move(response_message);
  const OperationView view = entry.view;
  done_.push_back(view.id);
  forget_oldest();
  return view;
}

bool Operations::report(const std::string& id, double progress, const std::string& stage) {
  std::unique_lock lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return false;
  Entry& entry = found->second;
  entry.view.progress = std::clamp(progress, entry.view.progress, 1.0);
  entry.view.stage = stage;
  const bool go_on = !entry.cancelled;
  notify(std::move(lock));
  return go_on;
}

void Operations::finish(const std::string& id, absl::StatusOr<std::string> response_message) {
  std::unique_lock lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return;
  OperationView& view = found->second.view;
  view.done = true;
  if (response_message.ok()) {
    view.progress = 1.0;
    view.stage = "done";
    view.response_message = *std::move(response_message);
  } else {
    view.error = response_message.status();
  }
  done_.push_back(id);
  forget_oldest();
  notify(std::move(lock));
}

void Operations::forget_oldest() {
  while (done_.size() > kMaxDone) {
    entries_.erase(done_.front());
    done_.pop_front();
  }
}

void Operations::drop(const std::string& id) {
  const std::lock_guard lock(mutex_);
  entries_.erase(id);
}

absl::StatusOr<OperationView> Operations::get(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return no_operation(id);
  return found->second.view;
}

absl::StatusOr<Owner> Operations::owner_of(const std::string& id) const {
  const auto view = get(id);
  if (!view.ok()) return view.status();
  return owner_of_view(*view);
}

std::vector<OperationView> Operations::list(const Scope& scope, const Page& page) const {
  const std::lock_guard lock(mutex_);
  std::vector<OperationView> views;
  for (auto entry = entries_.upper_bound(page.after); entry != entries_.end(); ++entry) {
    if (static_cast<int>(views.size()) == page.size) break;
    const Owner owner = owner_of_view(entry->second.view);
    if (scope.has(owner.tenant, owner.patient)) views.push_back(entry->second.view);
  }
  return views;
}

void Operations::wait(const std::string& id, std::chrono::milliseconds timeout, std::optional<double> seen_progress,
                      Reply reply) {
  std::unique_lock lock(mutex_);
  if (entries_.find(id) == entries_.end()) {
    lock.unlock();
    return reply(no_operation(id));
  }
  if (stopping_) {
    lock.unlock();
    return reply(draining());
  }
  waiters_.push_back({id, Clock::now() + timeout, seen_progress, std::move(reply)});
  notify(std::move(lock));
}

absl::Status Operations::cancel(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return no_operation(id);
  found->second.cancelled = true;
  return absl::OkStatus();
}

std::vector<Operations::Answer> Operations::take_answers(Clock::time_point now) {
  std::vector<Answer> answers;
  for (auto waiter = waiters_.begin(); waiter != waiters_.end();) {
    const auto entry = entries_.find(waiter->id);
    const bool gone = entry == entries_.end();
    const bool answer = gone || entry->second.view.done || waiter->deadline <= now ||
                        (waiter->seen_progress && *waiter->seen_progress != entry->second.view.progress);
    if (answer) {
      answers.push_back({std::move(waiter->reply), gone ? OperationView{} : entry->second.view});
      waiter = waiters_.erase(waiter);
    } else {
      ++waiter;
    }
  }
  return answers;
}

// Answers those who need not wait any longer, without the lock: a reply may come back here.
void Operations::notify(std::unique_lock<std::mutex> lock) {
  const std::vector<Answer> answers = take_answers(Clock::now());
  lock.unlock();
  changed_.notify_one();
  for (const Answer& answer : answers) {
    if (answer.view.id.empty()) {
      answer.reply(absl::NotFoundError("the operation was forgotten"));
    } else {
      answer.reply(answer.view);
    }
  }
}

void Operations::serve_timeouts() {
  name_this_thread("operations");
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    const auto next = std::min_element(waiters_.begin(), waiters_.end(),
                                       [](const Waiter& a, const Waiter& b) { return a.deadline < b.deadline; });
    if (next == waiters_.end()) {
      changed_.wait(lock);
    } else if (const Clock::time_point deadline = next->deadline; deadline > Clock::now()) {
      changed_.wait_until(lock, deadline);
    } else {
      notify(std::move(lock));
      lock = std::unique_lock(mutex_);
    }
  }
}

void Operations::stop() {
  std::unique_lock lock(mutex_);
  stopping_ = true;
  for (auto& [id, entry] : entries_) entry.cancelled = true;
  std::list<Waiter> waiters = std::exchange(waiters_, {});
  lock.unlock();
  changed_.notify_all();
  for (const Waiter& waiter : waiters) waiter.reply(draining());
}

}  // namespace lipofill::server
