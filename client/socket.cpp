#include "client/socket.h"

#include <charconv>
#include <chrono>
#include <memory>
#include <utility>

#include "proto/limits.h"

namespace obliq::client {

namespace {

constexpr std::string_view kThisMachine = "127.0.0.1";

}  // namespace

Socket::~Socket() { close(); }
Socket::Socket(Socket&& other) noexcept
    : socket_(std::exchange(other.socket_, kNoSocket)), tls_(std::move(other.tls_)) {}
Socket& Socket::operator=(Socket&& other) noexcept {
  if (this != &other) {
    close();
    socket_ = std::exchange(other.socket_, kNoSocket);
    tls_ = std::move(other.tls_);
  }
  return *this;
}

void Socket::close() {
  tls_.reset();
  if (is_open()) close_socket(socket_);
  socket_ = kNoSocket;
}

Status Socket::connect(const Endpoint& endpoint, Timeout timeout, Socket& out) {
  SocketHandle made = kNoSocket;
  Status status = connect_socket(endpoint.host, endpoint.port, timeout, made);
  if (status.ok()) {
    out.close();
    out.socket_ = made;
  } else {
    status.text = "cannot connect to " + endpoint.text() + ": " + status.text;
  }
  return status;
}

Status Socket::wait(Readiness what, Timeout timeout) {
  if (!is_open()) return Status::failure(Outcome::closed, "not connected");
  int error = 0;
  switch (await_socket(socket_, what, timeout, error)) {
    case Awaited::ready:
      return {};
    case Awaited::timed_out:
      return Status::failure(Outcome::timed_out, "the server did not answer in time");
    case Awaited::failed:
      break;
  }
  return Status::failure(Outcome::closed, socket_error_text(error));
}

Status Socket::wait_for(const Progress& progress, Timeout timeout) {
  switch (progress.kind) {
    case Progress::Kind::moved:
      return {};
    case Progress::Kind::wants_read:
      return wait(Readiness::readable, timeout);
    case Progress::Kind::wants_write:
      return wait(Readiness::writable, timeout);
    case Progress::Kind::ended:
      return Status::failure(Outcome::closed, "the server has closed the connection");
    case Progress::Kind::failed:
      break;
  }
  return Status::failure(Outcome::closed, "the connection to the server is gone: " + progress.reason);
}

Status Socket::start_tls(const std::string& host, const TlsOptions& options, Timeout timeout) {
  std::string failure;
  tls_ = Tls::make(socket_, host, options, failure);
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
  if (!tls_) return wait(Readiness::readable, timeout);
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
  const Transfer sent = send_bytes(socket_, bytes);
  if (sent.bytes >= 0) return {Progress::Kind::moved, static_cast<std::size_t>(sent.bytes)};
  if (sent.may_retry()) return {Progress::Kind::wants_write};
  return {Progress::Kind::failed, 0, socket_error_text(sent.error)};
}

Progress Socket::read_some(std::span<std::byte> bytes) {
  if (tls_) return tls_->read(bytes);
  const Transfer received = receive_bytes(socket_, bytes);
  if (received.bytes > 0) return {Progress::Kind::moved, static_cast<std::size_t>(received.bytes)};
  if (received.bytes == 0) return {Progress::Kind::ended};
  if (received.may_retry()) return {Progress::Kind::wants_read};
  return {Progress::Kind::failed, 0, socket_error_text(received.error)};
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
