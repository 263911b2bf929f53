#include "client/system_socket.h"

#ifdef _WIN32
// winsock2.h stands before all that includes windows.h.
#include <winsock2.h>
#include <ws2tcpip.h>
#else
#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <system_error>

namespace obliq::client {
namespace {

// ---- What differs ----

#ifdef _WIN32
using Length = int;
constexpr int kSendFlags = 0;
constexpr int kInterrupted = WSAEINTR;
constexpr int kRefused = WSAECONNREFUSED;
constexpr int kTimedOut = WSAETIMEDOUT;
// mingw-w64 names not all of them: ws2ipdef.h of the Windows SDK, "TCP_KEEPCNT" and so on, from Windows 10,
// version 1709.
constexpr int kKeepIdle = 3;
constexpr int kKeepCount = 16;
constexpr int kKeepInterval = 17;

int last_error() { return ::WSAGetLastError(); }
bool is_under_way(int error) { return error == WSAEWOULDBLOCK || error == WSAEINPROGRESS; }
bool would_block(int error) { return error == WSAEWOULDBLOCK || error == WSAEINTR; }
/// By select(): before Windows 10, version 2004, WSAPoll() waited for ever for a connection that was refused.
int poll_one(const WSAPOLLFD& entry, int timeout_ms) {
  fd_set ready, failed;
  FD_ZERO(&ready);
  FD_ZERO(&failed);
  FD_SET(entry.fd, &ready);
  FD_SET(entry.fd, &failed);
  timeval wait{timeout_ms / 1000, timeout_ms % 1000 * 1000};
  const bool reads = entry.events == POLLIN;
  return ::select(0, reads ? &ready : nullptr, reads ? nullptr : &ready, &failed, &wait);
}
void close_native(SOCKET socket) { ::closesocket(socket); }
SOCKET native(SocketHandle socket) { return static_cast<SOCKET>(socket); }
std::string lookup_error_text(int code) { return std::system_category().message(code); }

/// Once for the program.
bool has_network() {
  static const bool started = [] {
    WSADATA about{};
    return ::WSAStartup(MAKEWORD(2, 2), &about) == 0;
  }();
  return started;
}

SocketHandle open_native(const addrinfo& address) {
  const SOCKET made = ::socket(address.ai_family, address.ai_socktype, address.ai_protocol);
  if (made == INVALID_SOCKET) return kNoSocket;
  u_long on = 1;
  ::ioctlsocket(made, FIONBIO, &on);
  return static_cast<SocketHandle>(made);
}

template <class Value>
void set_option(SocketHandle socket, int level, int name, Value value) {
  (void)::setsockopt(native(socket), level, name, reinterpret_cast<const char*>(&value), sizeof value);
}

/// Windows has the default number of probes, and no limit for what is not acknowledged.
void set_user_timeout(SocketHandle) {}

using PollEntry = WSAPOLLFD;
#else
using Length = std::size_t;
constexpr int kSendFlags = MSG_NOSIGNAL;
constexpr int kInterrupted = EINTR;
constexpr int kRefused = ECONNREFUSED;
constexpr int kTimedOut = ETIMEDOUT;
constexpr int kKeepIdle = TCP_KEEPIDLE;
constexpr int kKeepCount = TCP_KEEPCNT;
constexpr int kKeepInterval = TCP_KEEPINTVL;

int last_error() { return errno; }
bool is_under_way(int error) { return error == EINPROGRESS; }
bool would_block(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }
int poll_one(pollfd& entry, int timeout_ms) { return ::poll(&entry, 1, timeout_ms); }
void close_native(int socket) { ::close(socket); }
int native(SocketHandle socket) { return static_cast<int>(socket); }
std::string lookup_error_text(int code) { return ::gai_strerror(code); }
bool has_network() { return true; }

SocketHandle open_native(const addrinfo& address) {
  return ::socket(address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, address.ai_protocol);
}

template <class Value>
void set_option(SocketHandle socket, int level, int name, Value value) {
  (void)::setsockopt(native(socket), level, name, &value, sizeof value);
}

void set_user_timeout(SocketHandle socket) { set_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, 60000u); }

using PollEntry = pollfd;
#endif

// ---- The same for both ----

/// Where nothing listens on a port of the range that outgoing connections take theirs from, TCP may connect a
/// socket to itself (RFC 793, simultaneous open). Who tries again and again meets that sooner or later.
bool is_own_peer(SocketHandle socket) {
  sockaddr_storage own{};
  sockaddr_storage peer{};
  socklen_t own_size = sizeof own;
  socklen_t peer_size = sizeof peer;
  return ::getsockname(native(socket), reinterpret_cast<sockaddr*>(&own), &own_size) == 0 &&
         ::getpeername(native(socket), reinterpret_cast<sockaddr*>(&peer), &peer_size) == 0 &&
         own_size == peer_size && std::memcmp(&own, &peer, static_cast<std::size_t>(own_size)) == 0;
}

/// 0, or the error.
int finish_connecting(SocketHandle socket, Timeout timeout) {
  int error = 0;
  if (await_socket(socket, Readiness::writable, timeout, error) == Awaited::timed_out) return kTimedOut;
  socklen_t size = sizeof error;
  if (::getsockopt(native(socket), SOL_SOCKET, SO_ERROR, reinterpret_cast<char*>(&error), &size) != 0)
    error = last_error();
  return error;
}

int connect_to(const addrinfo& address, Timeout timeout, SocketHandle& out) {
  const SocketHandle socket = open_native(address);
  if (socket == kNoSocket) return last_error();
  int error = 0;
  if (::connect(native(socket), address.ai_addr, static_cast<socklen_t>(address.ai_addrlen)) != 0) {
    error = last_error();
    if (is_under_way(error)) error = finish_connecting(socket, timeout);
  }
  if (error == 0 && is_own_peer(socket)) error = kRefused;
  if (error != 0) {
    close_socket(socket);
    return error;
  }
  // Requests are small and each waits for its answer; without this they would wait for one another too.
  set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  // A server whose machine has gone is noticed after a minute, also by a client that only waits (tcp(7)).
  set_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(socket, IPPROTO_TCP, kKeepIdle, 30);
  set_option(socket, IPPROTO_TCP, kKeepInterval, 10);
  set_option(socket, IPPROTO_TCP, kKeepCount, 3);
  set_user_timeout(socket);
  out = socket;
  return 0;
}

Length length_of(std::size_t bytes) {
  return static_cast<Length>(std::min<std::size_t>(bytes, std::numeric_limits<int>::max()));
}

Transfer transferred(std::int64_t bytes) { return {bytes, bytes < 0 ? last_error() : 0}; }

}  // namespace

bool Transfer::may_retry() const { return bytes < 0 && would_block(error); }

Status connect_socket(const std::string& host, std::uint16_t port, Timeout timeout, SocketHandle& out) {
  if (!has_network()) return Status::failure(Outcome::cannot_connect, socket_error_text(last_error()));
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int code = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (code != 0) return Status::failure(Outcome::cannot_connect, lookup_error_text(code));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, ::freeaddrinfo);
  Status last = Status::failure(Outcome::cannot_connect, "no address");
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    const int error = connect_to(*address, timeout, out);
    if (error == 0) return {};
    last.text = socket_error_text(error);
  }
  return last;
}

void close_socket(SocketHandle socket) { close_native(native(socket)); }

Awaited await_socket(SocketHandle socket, Readiness what, Timeout timeout, int& error) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    const auto left = std::chrono::ceil<Timeout>(end - std::chrono::steady_clock::now());
    PollEntry entry{native(socket), static_cast<short>(what == Readiness::readable ? POLLIN : POLLOUT), 0};
    const int n = poll_one(entry, static_cast<int>(std::max<Timeout::rep>(left.count(), 0)));
    if (n > 0) return Awaited::ready;
    if (n == 0) return Awaited::timed_out;
    error = last_error();
    if (error != kInterrupted) return Awaited::failed;
  }
}

Transfer send_bytes(SocketHandle socket, std::span<const std::byte> bytes) {
  return transferred(::send(native(socket), reinterpret_cast<const char*>(bytes.data()),
                            length_of(bytes.size()), kSendFlags));
}

Transfer receive_bytes(SocketHandle socket, std::span<std::byte> bytes) {
  return transferred(
      ::recv(native(socket), reinterpret_cast<char*>(bytes.data()), length_of(bytes.size()), 0));
}

std::string socket_error_text(int error) { return std::system_category().message(error); }

bool is_address(const std::string& host) {
  in6_addr any{};
  return has_network() &&
         (::inet_pton(AF_INET, host.c_str(), &any) == 1 || ::inet_pton(AF_INET6, host.c_str(), &any) == 1);
}

}  // namespace obliq::client
