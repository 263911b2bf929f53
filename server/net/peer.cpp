#include "server/net/peer.h"

#include <string_view>
#include <utility>

#include "server/log/log.h"
#include "server/log/service_log.h"
#include "server/net/rights.h"
#include "terrain/base/units.h"

namespace obliq::net {
namespace {

using wire::MessageType;

std::uint64_t bit(MessageType type) {
  const auto number = static_cast<unsigned>(type);
  return number < 64 ? std::uint64_t{1} << number : 0;
}

/// It asked for nothing but a pose and what goes with it.
bool only_moved(const Peer& peer) {
  const std::uint64_t of_a_pose = bit(MessageType::heartbeat) | bit(MessageType::list_radars) |
                                  bit(MessageType::get_radar) | bit(MessageType::claim_control) |
                                  bit(MessageType::release_control) | bit(MessageType::set_pose);
  return (peer.asked & bit(MessageType::set_pose)) != 0 && (peer.asked & ~of_a_pose) == 0;
}

std::string asked_for(const Peer& peer) {
  std::string names;
  for (const Right& right : rights())
    if ((peer.asked & bit(right.request)) != 0)
      names += (names.empty() ? "" : ", ") + std::string(right.name);
  return names.empty() ? "nothing" : names;
}

LogLevel level_of(const Peer& peer) { return peer.is_guest ? LogLevel::info : LogLevel::debug; }

}  // namespace

void log_arrival(Peer& peer, const std::string& introduction) {
  peer.introduction = introduction;
  log_debug("{} connected {}", peer.name, introduction);
}

void log_request(Peer& peer, MessageType type) {
  peer.asked |= bit(type);
  if (type == MessageType::subscribe) log_as_guest(peer);
}

void log_as_guest(Peer& peer) {
  if (std::exchange(peer.is_guest, true)) return;
  log_info("{} connected {}", peer.name, peer.introduction);
}

void log_doing(const Peer& peer, const std::string& radar, const std::string& what) {
  const LogFields fields{{"client", peer.name}, {"radar", radar}};
  log_line(level_of(peer), "radar {}: {}", radar, what);
}

void log_end(const Peer& peer) {
  const LogFields fields{{"client", peer.name}};
  if (peer.is_guest) return log_info("{} disconnected", peer.name);
  log_line(only_moved(peer) ? LogLevel::debug : LogLevel::info,
           "{} asked for {} and disconnected after {:.2f} s", peer.name, asked_for(peer),
           seconds_since(peer.since));
}

std::string_view advice(wire::ErrorNumber number) {
  using wire::ErrorNumber;
  switch (number) {
    case ErrorNumber::bad_magic:
    case ErrorNumber::bad_length:
    case ErrorNumber::bad_crc:
    case ErrorNumber::bad_message:
    case ErrorNumber::handshake_expected:
      return "; not an obliq client, or a broken one: check what runs there";
    case ErrorNumber::version_mismatch:
      return "; client and server need the same major version";
    case ErrorNumber::timed_out:
      return "; for a client on a slow line, raise server.handshake_timeout_s or "
             "server.message_timeout_s";
    case ErrorNumber::reads_too_slowly:
      return "; let it ask for a lower rate or fewer planes, or raise server.stall_timeout_s";
    case ErrorNumber::token_refused:
      return "; to let it in, give it a token of the file server.tokens";
    case ErrorNumber::tls_required:
      return "; start that client with TLS";
    case ErrorNumber::idle:
      return "; if it was only quiet, raise server.idle_timeout_s";
    default:
      return "";
  }
}

}  // namespace obliq::net
