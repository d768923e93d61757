#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace lipofill::server {

/// Why a connection was not taken, or was ended.
enum class TurnedAway {
  kFull,      ///< as many as there may be are open
  kPeerFull,  ///< as many as one address may have are open
  kNoFiles,   ///< the process or the machine has no descriptor left
  kSilent,    ///< it had not begun within its time
  kHostile,   ///< its frames are no client's
  kNoMemory,  ///< there is no memory to pass its bytes on
};
constexpr std::array<const char*, 6> kTurnedAwayNames = {"full",   "peer_full", "no_files",
                                                         "silent", "hostile",   "no_memory"};

/// Counts of the door, written by its thread and read by any.
struct DoorFigures {
  std::atomic<uint64_t> open = 0;
  std::atomic<uint64_t> accepted = 0;
  std::array<std::atomic<uint64_t>, kTurnedAwayNames.size()> turned_away{};
};

}  // namespace lipofill::server
