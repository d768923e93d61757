#pragma once

namespace lipofill::server {

/// Memory kept back for what cannot be refused. Where an allocation fails that belongs to one call
/// or simulation, that is refused or fails (MayFail). Others are of the transport, which reads a
/// request or sends an answer, and would end the process: they get what is kept back, and calls are
/// refused until it could be put back. It is address space, which costs nothing until it is used.
/// Checked by tests/unit/server/sessions/memory_reserve_test.cc and
/// tests/integration/service/scarce_memory_test.cc.
class MemoryReserve {
 public:
  /// Keeps memory back, for the rest of the process.
  static void set_up();
  /// Puts back what was used, where there is room again; to be called about once a second.
  static void refill();
  /// Lets a block of it go, so that an allocation that failed may be tried again. False where
  /// there is none.
  static bool give_up();
  /// True while some of it has been used.
  static bool is_short();
};

/// As long as it is there, an allocation of this thread that fails throws std::bad_alloc, and
/// somebody is there to catch that.
class MayFail {
 public:
  MayFail() { ++depth(); }
  ~MayFail() { --depth(); }
  MayFail(const MayFail&) = delete;
  MayFail& operator=(const MayFail&) = delete;

  static bool is_set() { return depth() > 0; }

 private:
  static int& depth() {
    static thread_local int depth = 0;
    return depth;
  }
};

}  // namespace lipofill::server
