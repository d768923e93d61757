#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lipofill::server {

/// Queue of those who wait to be let in, by groups. The next is of the group that has the fewest
/// in. Among groups with equally many it is of the one whose turn to be let in was longest ago, so
/// that groups take turns also where there is room for one only; in a group, and among groups of
/// which nobody was let in, first come, first served. A group without anybody in or waiting is
/// forgotten: when it comes again it is as one that was never there. Checked by
/// tests/unit/server/sessions/admission_queue_test.cc.
template <typename Item>
class AdmissionQueue {
 public:
  void push(Item item, const std::string& group) {
    groups_[group].waiting.push_back({std::move(item), ++n_came_});
    ++n_waiting_;
  }
  bool empty() const { return n_waiting_ == 0; }
  size_t size() const { return n_waiting_; }

  struct Admitted {
    Item item;
    std::string group;
  };
  /// Lets the next one in; only when there is one. Its group has one more in until leave().
  Admitted admit() {
    std::vector<Head> heads = make_heads();
    const Head& next = *std::min_element(heads.begin(), heads.end());
    Group& group = groups_.at(*next.name);
    Admitted admitted{std::move(group.waiting.front().item), *next.name};
    group.waiting.pop_front();
    ++group.n_in;
    group.last_admission = ++n_admissions_;
    --n_waiting_;
    return admitted;
  }
  /// One that was let in has left.
  void leave(const std::string& group) {
    const auto found = groups_.find(group);
    --found->second.n_in;
    forget_if_gone(found);
  }

  /// Place of the item for which `is` holds: 1 is the next, as things stand, if nobody came or left
  /// meanwhile; 0: it does not wait.
  template <typename Is>
  size_t position(Is&& is) const {
    std::vector<Head> heads = make_heads();
    for (size_t place = 1; place <= n_waiting_; ++place) {
      const auto next = std::min_element(heads.begin(), heads.end());
      if (is((*next->waiting)[next->n_ahead].item)) return place;
      if (++next->n_ahead == next->waiting->size()) {
        heads.erase(next);
      } else {
        next->rank = {next->rank.n_in + 1, n_admissions_ + place, (*next->waiting)[next->n_ahead].came};
      }
    }
    return 0;
  }
  /// Takes out the item for which `is` holds; false when it does not wait.
  template <typename Is>
  bool withdraw(Is&& is) {
    for (auto group = groups_.begin(); group != groups_.end(); ++group) {
      auto& waiting = group->second.waiting;
      const auto found = std::find_if(waiting.begin(), waiting.end(), [&](const Entry& e) { return is(e.item); });
      if (found == waiting.end()) continue;
      waiting.erase(found);
      --n_waiting_;
      forget_if_gone(group);
      return true;
    }
    return false;
  }

 private:
  struct Entry {
    Item item;
    uint64_t came;  ///< counts those that came
  };
  struct Group {
    size_t n_in = 0;
    uint64_t last_admission = 0;  ///< counts those let in; 0: none yet
    std::deque<Entry> waiting;
  };
  using Groups = std::map<std::string, Group>;

  /// The lowest is next. No two are equal: nobody came when another did.
  struct Rank {
    size_t n_in;
    uint64_t last_admission;
    uint64_t came;
    auto operator<=>(const Rank&) const = default;
  };
  /// The first of a group that waits, or would be after some were let in.
  struct Head {
    Rank rank;
    const std::string* name;
    const std::deque<Entry>* waiting;
    size_t n_ahead;
    bool operator<(const Head& other) const { return rank < other.rank; }
  };

  std::vector<Head> make_heads() const {
    std::vector<Head> heads;
    for (const auto& [name, group] : groups_) {
      if (group.waiting.empty()) continue;
      heads.push_back({{group.n_in, group.last_admission, group.waiting.front().came}, &name, &group.waiting, 0});
    }
    return heads;
  }
  void forget_if_gone(typename Groups::iterator group) {
    if (group->second.n_in == 0 && group->second.waiting.empty()) groups_.erase(group);
  }

  Groups groups_;
  size_t n_waiting_ = 0;
  uint64_t n_came_ = 0;
  uint64_t n_admissions_ = 0;
};

}  // namespace lipofill::server
