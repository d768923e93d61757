#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "absl/status/status.h"
#include "server/door/descriptor.h"
#include "server/door/door_figures.h"
#include "server/door/listening_socket.h"
#include "server/door/passage.h"

namespace lipofill::server {

/// The bounds say what the door lets in.
struct DoorBounds {
  size_t connections = 1024;
  size_t connections_per_peer = 128;         ///< of one address of the network; loopback counts in all only
  std::chrono::seconds to_begin{10};         ///< within this a connection must have sent something
  std::chrono::milliseconds unread{20'000};  ///< so long bytes may stay unacknowledged by a peer's machine
};

/// The name of the inner connection of a caller on a UNIX socket begins with this, as gRPC tells
/// it.
inline constexpr char kUnixCallers[] = "unix-abstract:lipofill-unix-";

/// The door of the daemon: accepts connections in place of gRPC, whose own listener stays deaf once
/// descriptors have run out (CVE-2023-4785 in 1.51), bounds their number, in all and for each
/// address, and passes what comes through a FrameMeter (Passage). gRPC gets one end of a pair of
/// sockets. One thread does it all. Checked by tests/unit/server/door/door_test.cc and
/// tests/integration/security/flood_test.cc.
class Door {
 public:
  /// Takes the inner end of a connection. `listener` is the number of its socket in `add`.
  using HandOver = std::function<void(int socket, size_t listener)>;

  explicit Door(DoorBounds bounds);
  ~Door();
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;

  /// Adds a socket before open(). What comes to it is metered unless it is encrypted.
  void add(ListeningSocket socket, bool is_encrypted);
  /// Starts to accept. INTERNAL when the kernel refuses what it takes.
  absl::Status open(HandOver hand_over);
  /// Ends all connections and accepts no more.
  void close();

  const DoorFigures& figures() const { return figures_; }

 private:
  struct Listener {
    ListeningSocket socket;
    bool is_encrypted = false;
  };
  struct Visitor {
    std::unique_ptr<Passage> passage;
    std::string peer;  ///< empty: not counted by address
    Passage::Clock::time_point came;
    uint32_t outer_events = 0;
    uint32_t inner_events = 0;
    bool is_scheduled = false;  ///< waits_ has it
  };
  using Visitors = std::unordered_map<uint64_t, Visitor>;

  void run();
  void accept_from(size_t listener);
  void turn_one_away(size_t listener);
  size_t count_of(const std::string& peer) const;
  void let_in_if_room(Descriptor outer, size_t listener, const std::string& peer);
  void let_in(Descriptor outer, size_t listener, const std::string& peer);
  void move(uint64_t id, bool is_lost);
  void watch(uint64_t id, Visitor& visitor);
  void end(Visitors::iterator visitor);
  /// Moves those whose wait is over, and ends those that have not begun in time.
  void look_at_clock();
  int milliseconds_to_wait() const;
  void count(TurnedAway why) { ++figures_.turned_away[static_cast<size_t>(why)]; }

  const DoorBounds bounds_;
  DoorFigures figures_;
  std::vector<Listener> listeners_;
  HandOver hand_over_;
  Descriptor poll_;
  Descriptor stop_;
  Descriptor spare_;  ///< is given up to turn a connection away when no other descriptor is left
  SharedAllowances allowances_;
  Visitors visitors_;
  std::map<std::string, size_t> by_peer_;
  std::multimap<Passage::Clock::time_point, uint64_t> waits_;
  uint64_t next_id_ = 1;
  Passage::Clock::time_point next_look_{};
  TokenBucket log_{1.0, 20.0};  ///< strangers must not fill the log
  std::thread thread_;
};

}  // namespace lipofill::server
