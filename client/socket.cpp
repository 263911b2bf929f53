#include "client/socket.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <system_error>
#include <utility>

#include "proto/limits.h"

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

// Where nothing listens on a port of the range that outgoing connections take theirs from, TCP may connect a
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
    // A server whose machine has gone is noticed after a minute, also by a client that only waits (tcp(7)).
    const int idle_s = 30;
    const int interval_s = 10;
    const int probes = 3;
    const unsigned user_timeout_ms = 60000;
    (void)::setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    (void)::setsockopt(fd, IPPROTO_TCP, TCP_KEEPIDLE, &idle_s, sizeof idle_s);
    (void)::setsockopt(fd, IPPROTO_TCP, TCP_KEEPINTVL, &interval_s, sizeof interval_s);
    (void)::setsockopt(fd, IPPROTO_TCP, TCP_KEEPCNT, &probes, sizeof probes);
    (void)::setsockopt(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &user_timeout_ms, sizeof user_timeout_ms);
    return {};
  }
  ::close(fd);
  fd = -1;
  return Status::failure(Outcome::cannot_connect, reason(error));
}

constexpr std::string_view kThisMachine = "127.0.0.1";

}  // namespace

Socket::~Socket() { close(); }
Socket::Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)), tls_(std::move(other.tls_)) {}
Socket& Socket::operator=(Socket&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = std::exchange(other.fd_, -1);
    tls_ = std::move(other.tls_);
  }
  return *this;
}

void Socket::close() {
  tls_.reset();
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

Status Socket::connect(const Endpoint& endpoint, Timeout timeout, Socket& out) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int code =
      ::getaddrinfo(endpoint.host.c_str(), std::to_string(endpoint.port).c_str(), &hints, &found);
  if (code != 0)
    return Status::failure(Outcome::cannot_connect, endpoint.text() + ": " + ::gai_strerror(code));
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

Status Socket::wait_for(const Progress& progress, Timeout timeout) {
  switch (progress.kind) {
    case Progress::Kind::moved:
      return {};
    case Progress::Kind::wants_read:
      return wait(POLLIN, timeout);
    case Progress::Kind::wants_write:
      return wait(POLLOUT, timeout);
    case Progress::Kind::ended:
      return Status::failure(Outcome::closed, "the server has closed the connection");
    case Progress::Kind::failed:
      break;
  }
  return Status::failure(Outcome::closed, "the connection to the server is gone: " + progress.reason);
}

Status Socket::start_tls(const std::string& host, const TlsOptions& options, Timeout timeout) {
  std::string failure;
  tls_ = Tls::make(fd_, host, options, failure);
  if (!tls_) return Status::failure(Outcome::bad_argument, failure);
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    const Progress progress = tls_->shake_hands();
    if (progress.kind == Progress::Kind::moved) return {};
    if (progress.kind == Progress::Kind::failed) return Status::failure(Outcome::untrusted, progress.reason);
    const auto left = std::chrono::ceil<Timeout>(end - std::chrono::steady_clock::now());
    if (Status status = wait_for(progress, std::max(left, Timeout(0))); !status.ok()) return status;
  }
}

std::vector<std::byte> Socket::give_up_tls() {
  if (!tls_) return {};
  std::vector<std::byte> first = tls_->first_bytes();
  tls_.reset();
  return first;
}

Status Socket::wait_readable(Timeout timeout) {
  if (!tls_) return wait(POLLIN, timeout);
  // What arrives may be TLS's own business: only decrypted bytes count.
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    const Progress progress = tls_->peek();
    const bool waits =
        progress.kind == Progress::Kind::wants_read || progress.kind == Progress::Kind::wants_write;
    if (!waits) return {};  // bytes, or an end that reading will tell
    const auto left = std::chrono::ceil<Timeout>(end - std::chrono::steady_clock::now());
    if (Status status = wait_for(progress, std::max(left, Timeout(0))); !status.ok()) return status;
  }
}

Progress Socket::write_some(std::span<const std::byte> bytes) {
  if (tls_) return tls_->write(bytes);
  const ssize_t n = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (n >= 0) return {Progress::Kind::moved, static_cast<std::size_t>(n)};
  if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) return {Progress::Kind::wants_write};
  return {Progress::Kind::failed, 0, reason(errno)};
}

Progress Socket::read_some(std::span<std::byte> bytes) {
  if (tls_) return tls_->read(bytes);
  const ssize_t n = ::recv(fd_, bytes.data(), bytes.size(), 0);
  if (n > 0) return {Progress::Kind::moved, static_cast<std::size_t>(n)};
  if (n == 0) return {Progress::Kind::ended};
  if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) return {Progress::Kind::wants_read};
  return {Progress::Kind::failed, 0, reason(errno)};
}

Status Socket::send(std::span<const std::byte> bytes, Timeout timeout) {
  while (!bytes.empty()) {
    const Progress progress = write_some(bytes);
    if (Status status = wait_for(progress, timeout); !status.ok()) return status;
    bytes = bytes.subspan(progress.bytes);
  }
  return {};
}

Status Socket::receive(std::span<std::byte> bytes, Timeout timeout) {
  while (!bytes.empty()) {
    const Progress progress = read_some(bytes);
    if (Status status = wait_for(progress, timeout); !status.ok()) return status;
    bytes = bytes.subspan(progress.bytes);
  }
  return {};
}

std::string Endpoint::text() const {
  const bool bracket = host.find(':') != std::string::npos;
  return (bracket ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

std::optional<Endpoint> parse_endpoint(std::string_view text) {
  std::string_view host = text;
  std::optional<std::string_view> port;
  if (text.starts_with('[')) {
    const std::size_t close = text.find(']');
    if (close == std::string_view::npos) return std::nullopt;
    host = text.substr(1, close - 1);
    const std::string_view rest = text.substr(close + 1);
    if (host.empty() || (!rest.empty() && rest.front() != ':')) return std::nullopt;
    if (!rest.empty()) port = rest.substr(1);
  } else if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    host = text.substr(0, colon);
    port = text.substr(colon + 1);
  } else if (text.find_first_not_of("0123456789") == std::string_view::npos) {
    host = {};
    port = text;
  }
  Endpoint endpoint{std::string(host.empty() ? kThisMachine : host), wire::kDefaultPort};
  if (!port) return endpoint;
  const auto [end, error] = std::from_chars(port->data(), port->data() + port->size(), endpoint.port);
  if (error != std::errc() || end != port->data() + port->size() || endpoint.port == 0) return std::nullopt;
  return endpoint;
}

}  // namespace obliq::client
