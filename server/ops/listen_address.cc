#include "server/ops/listen_address.h"

#include <arpa/inet.h>
#include <sys/un.h>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace lipofill::server {
namespace {

constexpr size_t kMaxUnixPath = sizeof(sockaddr_un::sun_path) - 1;

absl::StatusOr<ListenAddress> parse_unix(absl::string_view path) {
  absl::ConsumePrefix(&path, "//");
  if (path.empty() || path.size() > kMaxUnixPath) {
    return absl::InvalidArgumentError(
        absl::StrCat("the path of a UNIX socket has 1 to ", kMaxUnixPath, " bytes, this one has ", path.size()));
  }
  return ListenAddress{"", 0, std::string(path)};
}

}  // namespace

bool ListenAddress::is_local() const {
  if (is_unix() || host == "localhost") return true;
  in_addr four{};
  if (::inet_pton(AF_INET, host.c_str(), &four) == 1) return (ntohl(four.s_addr) >> 24) == 127;
  in6_addr six{};
  return ::inet_pton(AF_INET6, host.c_str(), &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six);
}

absl::StatusOr<ListenAddress> parse_listen_address(const std::string& text) {
  absl::string_view rest = text;
  if (absl::ConsumePrefix(&rest, "unix:")) return parse_unix(rest);
  const size_t colon = rest.rfind(':');
  if (colon == absl::string_view::npos || colon == 0) {
    return absl::InvalidArgumentError("must be HOST:PORT, [IPV6]:PORT or unix:PATH");
  }
  absl::string_view host = rest.substr(0, colon);
  const bool bracketed = absl::ConsumePrefix(&host, "[") && absl::ConsumeSuffix(&host, "]");
  if (!bracketed && absl::StrContains(host, ":")) {
    return absl::InvalidArgumentError("an IPv6 address goes in brackets: [::1]:50061");
  }
  ListenAddress address{std::string(host), 0, ""};
  if (!absl::SimpleAtoi(rest.substr(colon + 1), &address.port) || address.port < 0 || address.port > 65535) {
    return absl::InvalidArgumentError(
        absl::StrCat("the port is \"", rest.substr(colon + 1), "\", must be an integer in [0, 65535]"));
  }
  return address;
}

}  // namespace lipofill::server
