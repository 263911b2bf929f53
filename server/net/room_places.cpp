// Places: connections that have not said Hello have a few of their own, clients all others; and radars may
// leave the ground.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "server/log/log_fields.h"
#include "server/net/room.h"
#include "server/security/exposure.h"

namespace obliq::net {

void Room::note_ground(LiveRadar& radar, const std::string& warning) {
  const bool was_off = std::exchange(radar.off_the_map, !warning.empty());
  if (was_off == radar.off_the_map) return;
  const LogFields fields{{"radar", radar.name}};
  if (was_off) {
    spdlog::info("radar {}: is over ground that files cover again", radar.name);
  } else {
    spdlog::warn("radar {}: {}; name files of that ground in terrain.dem, or bring it back", radar.name,
                 warning);
  }
}

int Room::clients() const {
  return static_cast<int>(std::ranges::count_if(peers_, [](const auto& peer) { return peer->greeted; }));
}

std::optional<Room::NoPlace> Room::no_place_for(const Peer& peer) const {
  if (clients() >= options_.max_clients) {
    return NoPlace{wire::ErrorNumber::too_many_clients,
                   "too many clients: max_clients is " + std::to_string(options_.max_clients)};
  }
  // Of IPv6 the /64 network, which one host can have for itself.
  const std::string network = network_of(peer.host);
  const auto from_there = std::ranges::count_if(
      peers_, [&](const auto& other) { return other->greeted && network_of(other->host) == network; });
  if (from_there >= options_.max_clients_per_address) {
    return NoPlace{wire::ErrorNumber::too_many_from_address,
                   "too many clients from " + peer.host + ": max_clients_per_address is " +
                       std::to_string(options_.max_clients_per_address)};
  }
  return std::nullopt;
}

void Room::make_room_before_hello() {
  std::vector<std::string> waiting;
  for (const auto& peer : peers_)
    if (!peer->greeted) waiting.push_back(network_of(peer->host));
  if (static_cast<int>(waiting.size()) < options_.max_waiting) return;
  const std::string most = most_crowded(waiting);
  const auto oldest = *std::ranges::find_if(
      peers_, [&](const auto& peer) { return !peer->greeted && network_of(peer->host) == most; });
  const LogFields fields{{"client", oldest->name}};
  spdlog::warn(
      "{}: has not said Hello and makes room for a newcomer: server.max_waiting is {}; raise that limit, or "
      "see who is here",
      oldest->name, options_.max_waiting);
  oldest->drop();
}

}  // namespace obliq::net
