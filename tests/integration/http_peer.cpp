#include "tests/integration/http_peer.h"

#include <gtest/gtest.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "tests/support/loopback.h"

namespace obliq::test {

HttpPeer::HttpPeer(std::uint16_t port, const char* from) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
  const timeval limit{20, 0};  // reached only when something is broken
  setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  bind_to_loopback(fd_, ntohl(inet_addr(from)));
  connect_to_loopback(fd_, port);
}

HttpPeer::~HttpPeer() { close(fd_); }

bool HttpPeer::send(std::string_view text) const {
  while (!text.empty()) {
    const ssize_t n = ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL);
    if (n <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

bool HttpPeer::more() {
  std::array<char, 4096> part;
  const ssize_t n = recv(fd_, part.data(), part.size(), 0);
  if (n > 0) received_.append(part.data(), static_cast<std::size_t>(n));
  return n > 0;
}

HttpReply HttpPeer::receive(bool head) {
  HttpReply reply;
  while (received_.find("\r\n\r\n") == std::string::npos) {
    if (!more()) return reply;
  }
  const std::size_t end = received_.find("\r\n\r\n") + 4;
  reply.headers = received_.substr(0, end);
  std::transform(reply.headers.begin(), reply.headers.end(), reply.headers.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::string length_name = "\r\ncontent-length: ";
  const std::size_t at = reply.headers.find(length_name);
  const std::size_t length =
      at == std::string::npos || head ? 0 : std::stoul(reply.headers.substr(at + length_name.size()));
  while (received_.size() < end + length) {
    if (!more()) return reply;
  }
  reply.body = received_.substr(end, length);
  received_.erase(0, end + length);
  reply.status = std::stoi(reply.headers.substr(reply.headers.find(' ') + 1));
  return reply;
}

bool HttpPeer::closed() {
  while (more()) {
  }
  return errno != EAGAIN && errno != EWOULDBLOCK;
}

HttpReply http_get(std::uint16_t port, const std::string& path) {
  HttpPeer peer(port);
  peer.send("GET " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  return peer.receive();
}

std::uint16_t port_of(const std::string& address) {
  return static_cast<std::uint16_t>(std::stoi("0" + address.substr(address.rfind(':') + 1)));
}

}  // namespace obliq::test
