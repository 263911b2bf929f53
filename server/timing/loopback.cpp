#include "server/timing/loopback.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "terrain/base/errors.h"

namespace obliq {
namespace {

constexpr client::Timeout kLong{60000};

[[noreturn]] void refuse(const std::string& why) {
  throw InputError("loopback: found " + why + "; allowed: a connection to 127.0.0.1");
}

void check(const client::Status& status) {
  if (!status.ok()) refuse(status.sentence());
}

}  // namespace

Loopback::Loopback() {
  const UniqueFd listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  if (::bind(listener.get(), any, size) == 0 && ::listen(listener.get(), 1) == 0 &&
      ::getsockname(listener.get(), any, &size) == 0 &&
      client::Socket::connect({"127.0.0.1", ntohs(address.sin_port)}, kLong, socket_).ok())
    reader_end_.reset(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
  if (!reader_end_) refuse(std::strerror(errno));
  reader_ = std::jthread([this] { read(); });
}

Loopback::~Loopback() {
  socket_.close();
  reader_.join();
}

void Loopback::read() {
  std::vector<std::byte> buffer(std::size_t{1} << 20);
  for (;;) {
    const ssize_t n = ::read(reader_end_.get(), buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    received_ += static_cast<std::uint64_t>(n);
    received_.notify_one();
  }
}

void Loopback::send(std::span<const std::byte> bytes) {
  check(socket_.send(bytes, kLong));
  sent_ += bytes.size();
}

void Loopback::drain() const {
  for (std::uint64_t at = received_; at < sent_; at = received_) received_.wait(at);
}

}  // namespace obliq
