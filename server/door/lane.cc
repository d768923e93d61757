#include "server/door/lane.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace lipofill::server {
namespace {

bool is_passing(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

}  // namespace

bool Lane::read_from(int socket) {
  if (!has_room()) return true;
  if (begin_ > 0) {
    std::memmove(bytes_.data(), bytes_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  const ssize_t n = ::recv(socket, bytes_.data() + end_, bytes_.size() - end_, 0);
  if (n < 0) return is_passing(errno);
  if (n == 0) has_ended_ = true;
  end_ += static_cast<size_t>(n);
  return true;
}

bool Lane::write_to(int socket, size_t most) {
  const size_t size = std::min(most, end_ - begin_);
  if (size == 0) return true;
  const ssize_t n = ::send(socket, bytes_.data() + begin_, size, MSG_NOSIGNAL);
  if (n < 0) return is_passing(errno);
  begin_ += static_cast<size_t>(n);
  if (begin_ == end_) begin_ = end_ = 0;
  return true;
}

}  // namespace lipofill::server
