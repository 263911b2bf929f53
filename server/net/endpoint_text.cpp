#include "server/net/endpoint_text.h"

#include <sys/socket.h>

#include <boost/asio/ip/tcp.hpp>
#include <optional>

namespace obliq::net {
namespace {

using boost::asio::ip::tcp;

std::optional<tcp::endpoint> peer_of(int socket) {
  tcp::endpoint peer;
  auto size = static_cast<socklen_t>(peer.capacity());
  if (::getpeername(socket, peer.data(), &size) != 0) return std::nullopt;
  peer.resize(size);
  return peer;
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

}  // namespace obliq::net
