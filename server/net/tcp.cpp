#include "server/net/tcp.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cmath>
#include <optional>

#include "terrain/base/errors.h"

namespace obliq::net {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

std::optional<tcp::endpoint> peer_of(int socket) {
  tcp::endpoint peer;
  auto size = static_cast<socklen_t>(peer.capacity());
  if (::getpeername(socket, peer.data(), &size) != 0) return std::nullopt;
  peer.resize(size);
  return peer;
}

// Probes after the silence: more than one, since any may be lost.
constexpr int kProbes = 3;

template <typename Value>
bool set(int fd, int level, int option, Value value) {
  return ::setsockopt(fd, level, option, &value, sizeof value) == 0;
}

std::string text_of(const tcp::endpoint& endpoint) {
  return endpoint_text(endpoint.address().to_string(), endpoint.port());
}

tcp::endpoint resolve(asio::io_context& io, const std::string& address, std::uint16_t port) {
  error_code error;
  tcp::resolver resolver(io);
  const auto found = resolver.resolve(address, std::to_string(port),
                                      tcp::resolver::passive | tcp::resolver::numeric_service, error);
  if (error || found.empty())
    throw InputError("address: found " + address + " (" + error.message() +
                     "); allowed: an address of this machine");
  return found.begin()->endpoint();
}

}  // namespace

std::string endpoint_text(const std::string& host, std::uint16_t port) {
  const bool is_v6 = host.find(':') != std::string::npos;
  return (is_v6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

std::string host_of_peer(int socket) {
  const auto peer = peer_of(socket);
  return peer ? peer->address().to_string() : "?";
}

std::string endpoint_of_peer(int socket) {
  const auto peer = peer_of(socket);
  return peer ? endpoint_text(peer->address().to_string(), peer->port()) : "?";
}

bool watch_for_dead_peer(int socket_fd, double dead_after_s) {
  const int total_s = std::max(
      kMinDeadAfter_s, static_cast<int>(std::lround(std::min<double>(dead_after_s, kMaxDeadAfter_s))));
  const int interval_s = std::max(1, total_s / (2 * kProbes));
  const int idle_s = total_s - kProbes * interval_s;
  // With a user timeout the kernel gives up by that time, not by the count, and so it does with data that is
  // not acknowledged.
  const unsigned user_timeout_ms = 1000u * static_cast<unsigned>(total_s);
  bool ok = set(socket_fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  ok &= set(socket_fd, IPPROTO_TCP, TCP_KEEPIDLE, idle_s);
  ok &= set(socket_fd, IPPROTO_TCP, TCP_KEEPINTVL, interval_s);
  ok &= set(socket_fd, IPPROTO_TCP, TCP_KEEPCNT, kProbes);
  ok &= set(socket_fd, IPPROTO_TCP, TCP_USER_TIMEOUT, user_timeout_ms);
  return ok;
}

ReservedPort::ReservedPort(const std::string& address, std::uint16_t port) {
  asio::io_context io;
  const tcp::endpoint endpoint = resolve(io, address, port);
  tcp::acceptor socket(io);
  error_code error;
  const auto check = [&] {
    if (!error) return;
    std::string text = "cannot listen on " + text_of(endpoint) + ": " + error.message();
    if (error == boost::system::errc::address_in_use)
      text += "; end what listens there (another obliqd?), or take another port (0: any free one)";
    throw InputError(text);
  };
  socket.open(endpoint.protocol(), error);
  check();
  // Connections of a server that has just ended must not keep its port.
  socket.set_option(asio::socket_base::reuse_address(true), error);
  check();
  socket.bind(endpoint, error);
  check();
  is_v6_ = endpoint.address().is_v6();
  address_ = text_of(socket.local_endpoint(error));
  check();
  fd_.reset(socket.release(error));
  check();
}

}  // namespace obliq::net
