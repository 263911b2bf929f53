// Requests about roles and control.

#include <algorithm>
#include <cmath>
#include <variant>

#include "proto/limits.h"
#include "proto/message_header.h"
#include "proto/obliq.pb.h"
#include "server/net/peer.h"
#include "server/net/requests/requests.h"
#include "server/net/rights.h"
#include "server/net/room.h"
#include "server/rendering/replay_control.h"
#include "server/security/security.h"
#include "terrain/base/text.h"

namespace obliq::net {

using wire::ErrorNumber;
using wire::MessageType;

void Requests::hello(const wire::Hello& request) {
  if (request.major() != wire::kMajorVersion)
    return peer_.fail(ErrorNumber::version_mismatch,
                      "protocol version: found " + std::to_string(request.major()) + "." +
                          std::to_string(request.minor()) +
                          "; allowed: " + std::to_string(wire::kMajorVersion) + ".x");
  const security::Security& security = *room_.options().security;
  // A second Hello gets the same Welcome and changes nothing.
  if (!peer_.greeted) {
    const auto grant = security.grant(request.token());
    if (!grant)
      return peer_.fail(ErrorNumber::token_refused, request.token().empty()
                                                        ? "this server wants a token (obliq: --token-file)"
                                                        : "this server does not know the token");
    if (const auto none = room_.no_place_for(peer_)) return peer_.fail(none->number, none->text);
    peer_.role = grant->role;
    if (security.needs_token()) peer_.credential = grant->digest;
    std::string name = presentable(request.client_name());
    if (name.empty()) name = grant->name.empty() ? "client" : grant->name;
    peer_.name = name + " (" + peer_.address + ")";
    log_arrival(peer_, "as " + std::string(security::role_name(peer_.role)) +
                           (grant->name.empty() ? "" : " with the token of " + grant->name));
  }
  peer_.greeted = true;

  const ServerOptions& options = room_.options();
  wire::Welcome welcome;
  welcome.set_request_id(id_);
  welcome.set_major(wire::kMajorVersion);
  welcome.set_minor(wire::kMinorVersion);
  welcome.set_server_name(options.server_name);
  welcome.set_server_version(options.server_version);
  welcome.set_scene_name(options.scene_name);
  for (const LiveRadar& radar : room_.radars().all()) welcome.add_radars(radar.name);
  for (const auto encoding : {wire::IqEncoding::cf32_le, wire::IqEncoding::ci16_le}) {
    welcome.add_encodings(wire::encoding_name(encoding));
  }
  welcome.add_encodings(wire::compression_name(wire::Compression::zstd));
  wire::Limits& limits = *welcome.mutable_limits();
  limits.set_max_request_bytes(static_cast<std::uint32_t>(options.max_request_bytes));
  limits.set_max_plane_bytes(wire::kMaxPlaneBytes);
  limits.set_max_clients(static_cast<std::uint32_t>(options.max_clients));
  limits.set_max_renders_queued(static_cast<std::uint32_t>(options.max_renders_queued));
  limits.set_max_subscriptions(static_cast<std::uint32_t>(options.max_subscriptions));
  limits.set_max_rate_hz(options.max_rate_hz);
  limits.set_max_clients_per_address(static_cast<std::uint32_t>(options.max_clients_per_address));
  limits.set_max_bins(static_cast<std::uint64_t>(options.max_bins));
  limits.set_max_pixels(static_cast<std::uint64_t>(options.max_pixels));
  limits.set_max_work_queued(static_cast<std::uint64_t>(options.max_work_queued));
  if (std::isfinite(options.max_memory_mb))
    limits.set_max_memory_mb(static_cast<std::uint64_t>(options.max_memory_mb));
  limits.set_heartbeat_s(options.heartbeat_s);
  limits.set_idle_timeout_s(options.idle_timeout_s);
  limits.set_max_targets(static_cast<std::uint32_t>(options.max_targets));
  limits.set_max_query_points(options.query_ground ? wire::kMaxQueryPoints : 0);
  welcome.set_client_name(peer_.name);
  welcome.set_role(std::string(security::role_name(peer_.role)));
  welcome.set_truth(may_have_truth());
  peer_.send(MessageType::welcome, welcome);
  if (room_.replay() == nullptr) return;
  wire::ReplayState state;
  room_.replay()->write_state(state);
  peer_.send(MessageType::replay_state, state);
}

void Requests::heartbeat(const wire::Heartbeat& request) {
  if (!request.answer_wanted()) return;
  wire::Heartbeat answer;
  answer.set_request_id(id_);
  peer_.send(MessageType::heartbeat, answer);
}

bool Requests::demand(security::Role needed, const std::string& action) {
  if (peer_.role >= needed) return true;
  refuse(ErrorNumber::role_too_low, action + " needs the role " + std::string(security::role_name(needed)) +
                                        "; this client's token gives " +
                                        std::string(security::role_name(peer_.role)));
  return false;
}

bool Requests::may_have_truth() const { return peer_.role >= truth_role(room_.options()); }

bool Requests::demand_truth() {
  return demand(truth_role(room_.options()), "being told where targets are (server.truth_role)");
}

LiveRadar* Requests::claimed_radar(const std::string& name) {
  LiveRadar* radar = radar_of(name);
  return radar != nullptr && demand_claims(*radar, right_->claims) ? radar : nullptr;
}

bool Requests::demand_claims(const LiveRadar& radar, wire::ClaimSet claims) {
  if (radar.claims.holds(peer_, claims)) return true;
  const bool of_platform = radar.platform != nullptr && claims == wire::kPoseClaim;
  const std::string what = of_platform ? "platform " + radar.platform->name : "radar " + radar.name;
  if (const std::string held = radar.claims.sentence(claims, &peer_); !held.empty()) {
    refuse(ErrorNumber::controlled_by_other, what + ": " + held);
  } else {
    const auto lacking = static_cast<wire::ClaimSet>(claims & ~radar.claims.of(peer_));
    refuse(ErrorNumber::not_in_control,
           what + ": not claimed: " + wire::claim_names(lacking) + "; claim control first");
  }
  return false;
}

namespace {

/// What a message names of a radar's claims; none: `unnamed`, as far as the radar has it. Or why it may not.
/// The pose of a radar that rides is its platform's.
std::variant<wire::ClaimSet, FieldError> read_kinds(const LiveRadar& radar,
                                                    const google::protobuf::RepeatedField<int>& kinds,
                                                    wire::ClaimSet unnamed) {
  const wire::ClaimSet others = radar.platform ? wire::kPoseClaim : 0;
  if (kinds.empty()) return static_cast<wire::ClaimSet>(unnamed & ~others);
  wire::ClaimSet claims = 0;
  for (const int kind : kinds) {
    const auto claim = wire::claim_from_number(kind);
    if (!claim) return FieldError{"kinds", std::to_string(kind), "0 to " + std::to_string(wire::kClaims - 1)};
    claims |= claim_bit(*claim);
  }
  if ((claims & wire::kTargetsClaim) != 0)
    return FieldError{"kinds", "targets of radar " + radar.name,
                      "targets alone, with an empty radar: they are of the world"};
  if ((claims & others) != 0) return no_pose_of_its_own(radar, "radar");
  return claims;
}

/// The targets of the world, alone and without a radar.
template <typename Request>
bool names_targets(const Request& request) {
  return request.radar().empty() && request.kinds_size() == 1 && request.kinds(0) == wire::TARGETS_CLAIM;
}

}  // namespace

void Requests::claim_control(const wire::ClaimControl& request) {
  if (Platform* platform = room_.radars().find_platform(request.radar())) return claim(*platform, request);
  if (names_targets(request)) return claim_targets(request);
  if (request.radar().empty() &&
      std::ranges::find(request.kinds(), wire::TARGETS_CLAIM) != request.kinds().end())
    return refuse(ErrorNumber::invalid_value, "claim refused",
                  {{"kinds", std::to_string(request.kinds_size()) + " kinds",
                    "targets (2) alone: they are of the world"}});
  LiveRadar* radar = radar_of(request.radar());
  if (radar == nullptr) return;
  const auto kinds = read_kinds(*radar, request.kinds(), wire::kUnnamedClaims);
  if (const auto* fault = std::get_if<FieldError>(&kinds))
    return refuse(ErrorNumber::invalid_value, "claim refused", {*fault});
  const wire::ClaimSet wanted = std::get<wire::ClaimSet>(kinds);
  if (radar->claims.taken(wanted, &peer_) != 0) {
    if (!request.force())
      return refuse(ErrorNumber::controlled_by_other,
                    "radar " + radar->name + ": " + radar->claims.sentence(wanted, &peer_));
    if (!demand(security::Role::admin, "taking control over")) return;
  }
  room_.radars().claim(*radar, wanted, peer_);
  acknowledge(radar->settings.current()->version);
}

void Requests::release_control(const wire::ReleaseControl& request) {
  if (Platform* platform = room_.radars().find_platform(request.radar())) return release(*platform, request);
  if (names_targets(request)) return release_targets();
  LiveRadar* radar = radar_of(request.radar());
  if (radar == nullptr) return;
  const auto kinds = read_kinds(*radar, request.kinds(), wire::kEveryClaim);
  if (const auto* fault = std::get_if<FieldError>(&kinds))
    return refuse(ErrorNumber::invalid_value, "release refused", {*fault});
  const wire::ClaimSet wanted = std::get<wire::ClaimSet>(kinds);
  const wire::ClaimSet released = room_.radars().release(*radar, wanted, peer_);
  if (released == 0) return (void)demand_claims(*radar, wanted);
  log_doing(peer_, radar->name, wire::claim_names(released) + " released by " + peer_.name);
  acknowledge(radar->settings.current()->version);
}

void Requests::set_state(const wire::SetState& request) {
  LiveRadar* radar = claimed_radar(request.radar());
  if (radar == nullptr) return;
  RadarSwitches wanted;
  if (request.has_transmit()) wanted.transmit = request.transmit();
  if (request.has_freeze()) wanted.freeze = request.freeze();
  const auto before = ExerciseLog::switches_of(*radar);
  room_.radars().flip(*radar, wanted, peer_.name);
  room_.log().switched(*radar, before, peer_.name);
  acknowledge(radar->settings.current()->version);
}

void Requests::set_replay(const wire::SetReplay& request) {
  if (room_.replay() == nullptr)
    return refuse(
        ErrorNumber::not_a_replay,
        "this server's radars are live: pause, speed and seek are for a server that replays a recording "
        "(obliq replay FILE --serve)");
  wire::SetReplay place = request;
  std::vector<FieldError> errors = find_bookmark(place);
  if (errors.empty()) errors = room_.replay()->set(place);
  if (!errors.empty()) return refuse(ErrorNumber::invalid_value, "replay refused", errors);
  acknowledge();
}

}  // namespace obliq::net
