#include "server/apps/commands/fly/udp_socket.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "terrain/base/errors.h"

namespace obliq {
namespace {

in_addr address_of(const std::string& text, const char* option, const char* allowed) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1)
    throw InputError(fmt::format("{}: found \"{}\"; allowed: {}", option, text, allowed));
  return address;
}

}  // namespace

UniqueFd bind_udp(const std::string& address, const std::string& interface, int port, bool shared,
                  int& bound_port) {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(static_cast<std::uint16_t>(port));
  at.sin_addr = address_of(address, "--listen", "an IPv4 address of this machine, or a multicast group");
  const bool is_group = IN_MULTICAST(ntohl(at.sin_addr.s_addr));
  if (!interface.empty() && !is_group)
    throw InputError(fmt::format("--interface: found {} with --listen {}; allowed: with a multicast group",
                                 interface, address));
  UniqueFd socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int on = 1;
  if (shared || is_group) (void)setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  socklen_t size = sizeof at;
  if (socket.get() < 0 || bind(socket.get(), reinterpret_cast<sockaddr*>(&at), size) != 0 ||
      getsockname(socket.get(), reinterpret_cast<sockaddr*>(&at), &size) != 0)
    throw InputError(fmt::format("{}:{}: cannot be listened to: {}", address, port, std::strerror(errno)));
  bound_port = ntohs(at.sin_port);
  if (!is_group) return socket;
  ip_mreq group{at.sin_addr, {INADDR_ANY}};
  if (!interface.empty())
    group.imr_interface = address_of(interface, "--interface", "an IPv4 address of this machine");
  if (setsockopt(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0)
    throw InputError(
        fmt::format("{}: the group cannot be joined{}: {}", address,
                    interface.empty() ? "; --interface ADDRESS names the network" : " on " + interface,
                    std::strerror(errno)));
  return socket;
}

}  // namespace obliq
