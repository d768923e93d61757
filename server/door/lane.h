#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace lipofill::server {

/// One direction of a connection that is passed on: what was read from one socket and has yet to go
/// to the other, at most 64 KiB of it. Sockets do not block. Checked by
/// tests/unit/server/door/passage_test.cc.
class Lane {
 public:
  /// Reads what there is room for. False when the socket has failed.
  bool read_from(int socket);
  /// Writes what has come, at most `most` bytes of it. False when the socket has failed.
  bool write_to(int socket, size_t most);

  std::string_view waiting() const { return {bytes_.data() + begin_, end_ - begin_}; }
  bool has_room() const { return end_ - begin_ < bytes_.size() && !has_ended_; }
  /// True once the sender will send no more.
  bool has_ended() const { return has_ended_; }
  bool is_done() const { return has_ended_ && begin_ == end_; }

 private:
  std::array<char, 64 << 10> bytes_;
  size_t begin_ = 0;
  size_t end_ = 0;
  bool has_ended_ = false;
};

}  // namespace lipofill::server
