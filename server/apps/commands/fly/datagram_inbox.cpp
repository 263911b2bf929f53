#include "server/apps/commands/fly/datagram_inbox.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cstring>
#include <utility>

#include "server/security/networks.h"

namespace obliq {
namespace {

// IEEE 1278.2-2015: a PDU has at most 8,192 bytes; what is longer is cut, and only the rest of it is lost.
constexpr std::size_t kMostDatagram = 8192;
// 12 s of 10,000 PDUs a second, as far as the kernel grants it.
constexpr int kWantedBuffer = 16 << 20;
constexpr std::size_t kMostWaiting = std::size_t{16} << 20;  // while the server does not answer
constexpr int kLook_ms = 50;

/// Of the kernel's count of what it has dropped; the one before where the message has none.
std::uint32_t dropped_of(msghdr& message, std::uint32_t before) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part))
    if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == SO_RXQ_OVFL)
      std::memcpy(&before, CMSG_DATA(part), sizeof before);
  return before;
}

}  // namespace

DatagramInbox::DatagramInbox(UniqueFd socket, std::vector<std::string> allowed)
    : socket_(std::move(socket)), allowed_(std::move(allowed)) {
  const int on = 1;
  (void)setsockopt(socket_.get(), SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  // Beyond the system's limit with the right to it, else up to the limit.
  if (setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUFFORCE, &kWantedBuffer, sizeof kWantedBuffer) != 0)
    (void)setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &kWantedBuffer, sizeof kWantedBuffer);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

DatagramInbox::~DatagramInbox() {
  thread_.request_stop();
  thread_.join();
}

void DatagramInbox::run(const std::stop_token& stop) {
  std::vector<std::byte> buffer(kMostDatagram);
  while (!stop.stop_requested()) {
    pollfd waiting{socket_.get(), POLLIN, 0};
    if (poll(&waiting, 1, kLook_ms) > 0) receive(buffer);
  }
}

void DatagramInbox::receive(std::vector<std::byte>& buffer) {
  for (;;) {
    sockaddr_in from{};
    iovec part{buffer.data(), buffer.size()};
    alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(std::uint32_t))> control{};
    msghdr message{};
    message.msg_name = &from;
    message.msg_namelen = sizeof from;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = recvmsg(socket_.get(), &message, 0);
    if (size < 0) return;
    const std::uint32_t dropped = dropped_of(message, dropped_);
    lost_ += dropped - std::exchange(dropped_, dropped);
    if (!is_allowed(from.sin_addr.s_addr)) {
      ++not_allowed_;
      continue;
    }
    const auto bytes = std::span<const std::byte>(buffer).first(static_cast<std::size_t>(size));
    const std::lock_guard lock(mutex_);
    if (waiting_.bytes.size() + bytes.size() + sizeof(Datagrams::One) * waiting_.all.size() > kMostWaiting) {
      ++lost_;
      continue;
    }
    waiting_.all.push_back({waiting_.bytes.size(), bytes.size(), std::chrono::steady_clock::now(),
                            std::chrono::system_clock::now()});
    waiting_.bytes.insert(waiting_.bytes.end(), bytes.begin(), bytes.end());
    came_.notify_one();
  }
}

bool DatagramInbox::is_allowed(std::uint32_t address) {
  if (allowed_.empty()) return true;
  if (address == known_address_) return known_is_allowed_;
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address, text.data(), text.size());
  known_address_ = address;
  known_is_allowed_ = security::is_within(text.data(), allowed_);
  return known_is_allowed_;
}

Datagrams DatagramInbox::take(std::chrono::milliseconds longest) {
  std::unique_lock lock(mutex_);
  came_.wait_for(lock, longest, [this] { return !waiting_.all.empty(); });
  return std::exchange(waiting_, {});
}

}  // namespace obliq
