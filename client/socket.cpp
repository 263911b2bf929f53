#include "client/socket.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <system_error>
#include <utility>

namespace obliq::client {
namespace {

std::string reason(int error) { return std::system_category().message(error); }

// Poll for what is left of the time, however often a signal interrupts it.
int poll_until(int fd, short events, Timeout timeout) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    const auto left = std::chrono::ceil<Timeout>(end - std::chrono::steady_clock::now());
    pollfd entry{fd, events, 0};
    const int n = ::poll(&entry, 1, static_cast<int>(std::max<Timeout::rep>(left.count(), 0)));
    if (n >= 0 || errno != EINTR) return n;
  }
}

// Where nobody listens on a port of the range that outgoing connections take theirs from, TCP may connect a
// socket to itself (RFC 793, simultaneous open). Who tries again and again meets that sooner or later.
bool is_own_peer(int fd) {
  sockaddr_storage own{};
  sockaddr_storage peer{};
  socklen_t own_size = sizeof own;
  socklen_t peer_size = sizeof peer;
  return ::getsockname(fd, reinterpret_cast<sockaddr*>(&own), &own_size) == 0 &&
         ::getpeername(fd, reinterpret_cast<sockaddr*>(&peer), &peer_size) == 0 && own_size == peer_size &&
         std::memcmp(&own, &peer, own_size) == 0;
}

Status connect_to(const addrinfo& address, Timeout timeout, int& fd) {
  fd = ::socket(address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, address.ai_protocol);
  if (fd < 0) return Status::failure(Outcome::cannot_connect, reason(errno));
  int error = 0;
  if (::connect(fd, address.ai_addr, address.ai_addrlen) != 0) {
    error = errno;
    if (error == EINPROGRESS) {
      error = 0;
      if (poll_until(fd, POLLOUT, timeout) == 0) {
        error = ETIMEDOUT;
      } else {
        socklen_t size = sizeof error;
        if (::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
      }
    }
  }
  if (error == 0 && is_own_peer(fd)) error = ECONNREFUSED;
  if (error == 0) {
    // Requests are small and each waits for its answer; without this they would wait for one another too.
    const int on = 1;
    (void)::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return {};
  }
  ::close(fd);
  fd = -1;
  return Status::failure(Outcome::cannot_connect, reason(error));
}

}  // namespace

Socket::~Socket() { close(); }
Socket::Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
Socket& Socket::operator=(Socket&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = std::exchange(other.fd_, -1);
  }
  return *this;
}

void Socket::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

Status Socket::connect(const Endpoint& endpoint, Timeout timeout, Socket& out) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int code =
      ::getaddrinfo(endpoint.host.c_str(), std::to_string(endpoint.port).c_str(), &hints, &found);
  if (code != 0) {
    return Status::failure(Outcome::cannot_connect, endpoint.text() + ": " + ::gai_strerror(code));
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, ::freeaddrinfo);
  Status last = Status::failure(Outcome::cannot_connect, "no address");
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    int fd = -1;
    last = connect_to(*address, timeout, fd);
    if (last.ok()) {
      out.close();
      out.fd_ = fd;
      return last;
    }
  }
  last.text = "cannot connect to " + endpoint.text() + ": " + last.text;
  return last;
}

Status Socket::wait(short events, Timeout timeout) {
  if (fd_ < 0) return Status::failure(Outcome::closed, "not connected");
  const int n = poll_until(fd_, events, timeout);
  if (n > 0) return {};
  if (n == 0) return Status::failure(Outcome::timed_out, "the server did not answer in time");
  return Status::failure(Outcome::closed, reason(errno));
}

Status Socket::wait_readable(Timeout timeout) { return wait(POLLIN, timeout); }

Status Socket::send(std::span<const std::byte> bytes, Timeout timeout) {
  while (!bytes.empty()) {
    const ssize_t n = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (Status status = wait(POLLOUT, timeout); !status.ok()) return status;
    } else if (errno != EINTR) {
      return Status::failure(Outcome::closed, "the connection to the server is gone: " + reason(errno));
    }
  }
  return {};
}

Status Socket::receive(std::span<std::byte> bytes, Timeout timeout) {
  while (!bytes.empty()) {
    const ssize_t n = ::recv(fd_, bytes.data(), bytes.size(), 0);
    if (n > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    } else if (n == 0) {
      return Status::failure(Outcome::closed, "the server has closed the connection");
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (Status status = wait(POLLIN, timeout); !status.ok()) return status;
    } else if (errno != EINTR) {
      return Status::failure(Outcome::closed, "the connection to the server is gone: " + reason(errno));
    }
  }
  return {};
}

}  // namespace obliq::client
