#include "server/asterix/udp_target.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netdb.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>

#include "terrain/base/errors.h"

namespace obliq::asterix {
namespace {

// Datagrams handed to the kernel in one call.
constexpr std::size_t kMostAtOnce = 32;

InputError not_a_target(const std::string& text, const std::string& found) {
  return InputError(fmt::format(
      "--to: found \"{}\"{}; allowed: HOST:PORT with an IPv4 address or a name that has one, such as "
      "239.192.24.1:8600",
      text, found));
}

sockaddr_in address_of(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  // Neither an IPv4 address nor a name has a colon of its own; "[::1]:8600" and "::1" have.
  if (colon != text.find(':')) throw not_a_target(text, " (an IPv6 address: CAT 240 is sent over IPv4 only)");
  std::uint16_t port = 0;
  const char* const end = text.data() + text.size();
  if (colon == 0 || colon == std::string::npos) throw not_a_target(text, "");
  const auto [parsed, fault] = std::from_chars(text.data() + colon + 1, end, port);
  if (fault != std::errc() || parsed != end || port == 0) throw not_a_target(text, "");
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(text.substr(0, colon).c_str(), nullptr, &hints, &found);
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, freeaddrinfo);
  if (error != 0 || found == nullptr) throw not_a_target(text, fmt::format(" ({})", gai_strerror(error)));
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof address);
  address.sin_port = htons(port);
  if (address.sin_addr.s_addr == INADDR_ANY || address.sin_addr.s_addr == INADDR_BROADCAST)
    throw not_a_target(text, ", which is no receiver");
  return address;
}

void set_option(int socket, int option, const void* value, socklen_t size, const std::string& what) {
  if (setsockopt(socket, IPPROTO_IP, option, value, size) != 0)
    throw InputError(fmt::format("{}: cannot be set: {}", what, std::strerror(errno)));
}

}  // namespace

UdpTarget::UdpTarget(const UdpOptions& options)
    : to_(address_of(options.to)), socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  if (!socket_) throw InputError(fmt::format("a UDP socket cannot be made: {}", std::strerror(errno)));
  const int option = is_multicast() ? IP_MULTICAST_TTL : IP_TTL;
  set_option(socket_.get(), option, &options.ttl, sizeof options.ttl, fmt::format("--ttl {}", options.ttl));
  if (options.interface.empty()) return;
  sockaddr_in from{};
  from.sin_family = AF_INET;
  const auto refuse = [&](const std::string& why) {
    return InputError(fmt::format("--interface: found \"{}\"{}; allowed: an IPv4 address of this machine",
                                  options.interface, why));
  };
  if (inet_pton(AF_INET, options.interface.c_str(), &from.sin_addr) != 1) throw refuse("");
  if (bind(socket_.get(), reinterpret_cast<const sockaddr*>(&from), sizeof from) != 0)
    throw refuse(fmt::format(" ({})", std::strerror(errno)));
  if (is_multicast())
    set_option(socket_.get(), IP_MULTICAST_IF, &from.sin_addr, sizeof from.sin_addr,
               "--interface " + options.interface);
}

bool UdpTarget::is_multicast() const { return IN_MULTICAST(ntohl(to_.sin_addr.s_addr)); }

std::string UdpTarget::text() const {
  char address[INET_ADDRSTRLEN] = {};
  inet_ntop(AF_INET, &to_.sin_addr, address, sizeof address);
  return fmt::format("{}:{}", address, ntohs(to_.sin_port));
}

std::size_t UdpTarget::send(std::span<const std::vector<std::byte>> datagrams, int& error) {
  std::size_t sent = 0;
  while (sent < datagrams.size()) {
    std::array<mmsghdr, kMostAtOnce> messages{};
    std::array<iovec, kMostAtOnce> parts{};
    const std::size_t n = std::min(kMostAtOnce, datagrams.size() - sent);
    for (std::size_t i = 0; i < n; ++i) {
      const std::vector<std::byte>& datagram = datagrams[sent + i];
      // The system's structure is for reading as well.
      parts[i] = {const_cast<std::byte*>(datagram.data()), datagram.size()};
      messages[i].msg_hdr.msg_name = &to_;
      messages[i].msg_hdr.msg_namelen = sizeof to_;
      messages[i].msg_hdr.msg_iov = &parts[i];
      messages[i].msg_hdr.msg_iovlen = 1;
    }
    const int taken = sendmmsg(socket_.get(), messages.data(), static_cast<unsigned>(n), 0);
    if (taken < 0 && errno == EINTR) continue;
    if (taken <= 0) {
      error = errno;
      return sent;
    }
    sent += static_cast<std::size_t>(taken);
  }
  return sent;
}

}  // namespace obliq::asterix
