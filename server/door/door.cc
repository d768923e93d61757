#include "server/door/door.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>

#include "absl/strings/str_cat.h"
#include "server/door/peer_socket.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

using Clock = Passage::Clock;

constexpr uint64_t kStop = 0;
constexpr uint64_t kListeners = uint64_t{1} << 63;  ///< this bit and the listener's number
constexpr int kAtOnce = 64;
constexpr std::chrono::milliseconds kLookPeriod{500};

/// A visitor's two sockets: 2 id, 2 id + 1.
constexpr uint64_t outer_key(uint64_t id) {
  return 2 * id;
}
constexpr uint64_t inner_key(uint64_t id) {
  return 2 * id + 1;
}

/// Watches a socket for what is wanted now; one for nothing is not watched, for the kernel tells of
/// ends unasked.
void update(int poll, int socket, uint64_t key, uint32_t wanted, uint32_t& watched) {
  if (wanted == watched) return;
  epoll_event event{};
  event.events = wanted;
  event.data.u64 = key;
  ::epoll_ctl(poll, wanted == 0 ? EPOLL_CTL_DEL : watched == 0 ? EPOLL_CTL_ADD : EPOLL_CTL_MOD, socket, &event);
  watched = wanted;
}

Descriptor make_spare() {
  return Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC));
}

}  // namespace

Door::Door(DoorBounds bounds) : bounds_(bounds), spare_(make_spare()) {}

Door::~Door() {
  close();
}

void Door::add(ListeningSocket socket, bool is_encrypted) {
  listeners_.push_back({std::move(socket), is_encrypted});
}

absl::Status Door::open(HandOver hand_over) {
  hand_over_ = std::move(hand_over);
  poll_ = Descriptor(::epoll_create1(EPOLL_CLOEXEC));
  stop_ = Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!poll_.is_open() || !stop_.is_open()) {
    return absl::InternalError(absl::StrCat("cannot wait for connections: ", std::strerror(errno)));
  }
  uint32_t unwatched = 0;
  update(poll_.get(), stop_.get(), kStop, EPOLLIN, unwatched);
  for (size_t i = 0; i < listeners_.size(); ++i) {
    unwatched = 0;
    update(poll_.get(), listeners_[i].socket.socket.get(), kListeners | i, EPOLLIN, unwatched);
  }
  thread_ = std::thread([this] { run(); });
  return absl::OkStatus();
}

void Door::close() {
  if (!thread_.joinable()) return;
  ::eventfd_write(stop_.get(), 1);
  thread_.join();
  visitors_.clear();
  figures_.open = 0;
  for (const Listener& listener : listeners_) {
    if (!listener.socket.unix_path.empty()) ::unlink(listener.socket.unix_path.c_str());
  }
  listeners_.clear();
}

void Door::run() {
  ::pthread_setname_np(::pthread_self(), "door");
  std::array<epoll_event, kAtOnce> events;
  while (true) {
    const int n = ::epoll_wait(poll_.get(), events.data(), kAtOnce, milliseconds_to_wait());
    for (int i = 0; i < n; ++i) {
      const uint64_t key = events[i].data.u64;
      if (key == kStop) return;
      if ((key & kListeners) != 0) {
        accept_from(key & ~kListeners);
      } else {
        // The inner socket's end follows what gRPC has yet to say; the outer one's takes no answer.
        const bool is_outer = key % 2 == 0;
        move(key / 2, is_outer && (events[i].events & (EPOLLERR | EPOLLHUP)) != 0);
      }
    }
    look_at_clock();
  }
}

void Door::accept_from(size_t listener) {
  for (int i = 0; i < kAtOnce; ++i) {
    sockaddr_storage peer{};
    socklen_t size = sizeof peer;
    Descriptor outer(::accept4(listeners_[listener].socket.socket.get(), reinterpret_cast<sockaddr*>(&peer), &size,
                               SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!outer.is_open()) {
      if (errno == EMFILE || errno == ENFILE || errno == ENOMEM || errno == ENOBUFS) turn_one_away(listener);
      return;
    }
    ++figures_.accepted;
    const std::string address = counted_address(peer);
    if (visitors_.size() >= bounds_.connections) {
      count(TurnedAway::kFull);
    } else if (!address.empty() && count_of(address) >= bounds_.connections_per_peer) {
      count(TurnedAway::kPeerFull);
    } else {
      let_in_if_room(std::move(outer), listener, address);
    }
  }
}

// The kernel goes on to tell of a connection that cannot be accepted; it is taken by the descriptor
// that is kept for this, and closed.
void Door::turn_one_away(size_t listener) {
  count(TurnedAway::kNoFiles);
  spare_.close();
  Descriptor(::accept4(listeners_[listener].socket.socket.get(), nullptr, nullptr, SOCK_CLOEXEC)).close();
  spare_ = make_spare();
}

size_t Door::count_of(const std::string& peer) const {
  const auto counted = by_peer_.find(peer);
  return counted != by_peer_.end() ? counted->second : 0;
}

void Door::let_in_if_room(Descriptor outer, size_t listener, const std::string& peer) {
  try {
    let_in(std::move(outer), listener, peer);
  } catch (const std::bad_alloc&) {
    count(TurnedAway::kNoMemory);
  }
}

void Door::let_in(Descriptor outer, size_t listener, const std::string& peer) {
  const Listener& through = listeners_[listener];
  const bool is_unix = !through.socket.unix_path.empty();
  const uint64_t id = next_id_++;
  auto pair = make_inner_pair(is_unix ? "unix" : "tcp", id);
  if (!pair) return count(TurnedAway::kNoFiles);
  if (!is_unix) set_up_peer_socket(outer.get(), bounds_.unread);
  auto meter = through.is_encrypted ? nullptr : std::make_unique<FrameMeter>(allowances_);
  Visitor visitor{std::make_unique<Passage>(std::move(outer), std::move(pair->ours), std::move(meter)), peer,
                  Clock::now()};
  if (!peer.empty()) ++by_peer_[peer];
  const auto [entry, _] = visitors_.emplace(id, std::move(visitor));
  figures_.open = visitors_.size();
  hand_over_(pair->grpcs.release(), listener);
  watch(id, entry->second);
}

void Door::move(uint64_t id, bool is_lost) {
  const auto found = visitors_.find(id);
  if (found == visitors_.end()) return;
  Passage& passage = *found->second.passage;
  passage.move(Clock::now());
  if (!passage.hostile().empty()) {
    count(TurnedAway::kHostile);
    if (log_.take(Clock::now())) spdlog::warn("a connection is ended: it {}", passage.hostile());
  }
  if (is_lost || passage.is_over()) return end(found);
  if (passage.wait() && !found->second.is_scheduled) {
    waits_.emplace(*passage.wait(), id);
    found->second.is_scheduled = true;
  }
  watch(id, found->second);
}

void Door::watch(uint64_t id, Visitor& visitor) {
  const Passage& passage = *visitor.passage;
  update(poll_.get(), passage.outer(), outer_key(id), passage.outer_events(), visitor.outer_events);
  update(poll_.get(), passage.inner(), inner_key(id), passage.inner_events(), visitor.inner_events);
}

void Door::end(Visitors::iterator visitor) {
  const std::string& peer = visitor->second.peer;
  if (const auto counted = by_peer_.find(peer); counted != by_peer_.end() && --counted->second == 0) {
    by_peer_.erase(counted);
  }
  visitors_.erase(visitor);
  figures_.open = visitors_.size();
}

void Door::look_at_clock() {
  const Clock::time_point now = Clock::now();
  while (!waits_.empty() && waits_.begin()->first <= now) {
    const uint64_t id = waits_.begin()->second;
    waits_.erase(waits_.begin());
    const auto visitor = visitors_.find(id);
    if (visitor == visitors_.end()) continue;
    visitor->second.is_scheduled = false;
    move(id, false);
  }
  if (now < next_look_) return;
  next_look_ = now + kLookPeriod;
  for (auto visitor = visitors_.begin(); visitor != visitors_.end();) {
    const auto current = visitor++;
    const bool is_late = now - current->second.came > bounds_.to_begin;
    if (!is_late || current->second.passage->has_begun()) continue;
    count(TurnedAway::kSilent);
    end(current);
  }
}

int Door::milliseconds_to_wait() const {
  const Clock::time_point until = waits_.empty() ? next_look_ : std::min(next_look_, waits_.begin()->first);
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
  return static_cast<int>(std::clamp<int64_t>(left, 0, kLookPeriod.count()));
}

}  // namespace lipofill::server
