#include "server/net/visits.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <string_view>
#include <utility>

#include "server/log/log_fields.h"
#include "server/net/peer.h"

namespace obliq::net {
namespace {

using wire::MessageType;

constexpr std::pair<MessageType, std::string_view> kNames[] = {
    {MessageType::list_radars, "ListRadars"},   {MessageType::get_radar, "GetRadar"},
    {MessageType::get_status, "GetStatus"},     {MessageType::claim_control, "ClaimControl"},
    {MessageType::set_settings, "SetSettings"}, {MessageType::set_state, "SetState"},
    {MessageType::set_pose, "SetPose"},         {MessageType::release_control, "ReleaseControl"},
    {MessageType::unsubscribe, "Unsubscribe"},  {MessageType::render_once, "RenderOnce"},
};

std::uint64_t bit(MessageType type) {
  const auto number = static_cast<unsigned>(type);
  return number < 64 ? std::uint64_t{1} << number : 0;
}

/// Nothing but a pose, and what belongs to it.
bool only_moved(const Peer& peer) {
  const std::uint64_t of_a_pose = bit(MessageType::heartbeat) | bit(MessageType::list_radars) |
                                  bit(MessageType::get_radar) | bit(MessageType::claim_control) |
                                  bit(MessageType::release_control) | bit(MessageType::set_pose);
  return (peer.asked & bit(MessageType::set_pose)) != 0 && (peer.asked & ~of_a_pose) == 0;
}

std::string asked_for(const Peer& peer) {
  std::string names;
  for (const auto& [type, name] : kNames)
    if ((peer.asked & bit(type)) != 0) names += (names.empty() ? "" : ", ") + std::string(name);
  return names.empty() ? "nothing" : names;
}

spdlog::level::level_enum level_of(const Peer& peer) {
  return peer.is_guest ? spdlog::level::info : spdlog::level::debug;
}

}  // namespace

void log_arrival(Peer& peer, const std::string& introduction) {
  peer.introduction = introduction;
  spdlog::debug("{} has come {}", peer.name, introduction);
}

void log_request(Peer& peer, MessageType type) {
  peer.asked |= bit(type);
  if (type == MessageType::subscribe) log_as_guest(peer);
}

void log_as_guest(Peer& peer) {
  if (std::exchange(peer.is_guest, true)) return;
  spdlog::info("{} has come {}", peer.name, peer.introduction);
}

void log_doing(const Peer& peer, const std::string& radar, const std::string& what) {
  const LogFields fields{{"client", peer.name}, {"radar", radar}};
  spdlog::log(level_of(peer), "radar {}: {}", radar, what);
}

void log_end(const Peer& peer) {
  const LogFields fields{{"client", peer.name}};
  if (peer.is_guest) return spdlog::info("{} has gone", peer.name);
  const std::chrono::duration<double> stayed = std::chrono::steady_clock::now() - peer.since;
  spdlog::log(only_moved(peer) ? spdlog::level::debug : spdlog::level::info,
              "{} asked for {}, and has gone after {:.2f} s", peer.name, asked_for(peer), stayed.count());
}

}  // namespace obliq::net
