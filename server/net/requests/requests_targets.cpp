// Requests about the targets of the world.
#include "proto/obliq.pb.h"
#include "server/net/peer.h"
#include "server/net/requests/request_limits.h"
#include "server/net/requests/requests.h"
#include "server/net/room.h"

namespace obliq::net {

using wire::ErrorNumber;
using wire::MessageType;

void Requests::claim_targets(const wire::ClaimControl& request) {
  const std::string held = room_.targets().claims().sentence(wire::kTargetsClaim, &peer_);
  if (!held.empty()) {
    if (!request.force()) return refuse(ErrorNumber::controlled_by_other, held);
    if (!demand(security::Role::admin, "taking targets over")) return;
  }
  room_.targets().claim(peer_);
  acknowledge();
}

void Requests::release_targets() {
  if (!room_.targets().release(peer_, " by " + peer_.name)) return (void)demand_targets();
  acknowledge();
}

bool Requests::demand_targets() {
  const Claims& claims = room_.targets().claims();
  if (claims.holds(peer_, wire::kTargetsClaim)) return true;
  if (const std::string held = claims.sentence(wire::kTargetsClaim, &peer_); !held.empty()) {
    refuse(ErrorNumber::controlled_by_other, held);
  } else {
    refuse(ErrorNumber::not_in_control, "not claimed: targets; claim them first");
  }
  return false;
}

void Requests::set_targets(const wire::SetTargets& request) {
  if (!demand_targets()) return;
  const TargetWorld::Outcome outcome = room_.targets().set(request, peer_.name);
  if (outcome.too_many)
    return refuse({"max_targets",
                   "max_targets is " + std::to_string(room_.options().max_targets) + ": nothing was changed",
                   outcome.errors.front()});
  if (!outcome.errors.empty()) return refuse(ErrorNumber::invalid_value, "targets refused", outcome.errors);
  wire::Ack ack;
  ack.set_request_id(id_);
  for (const std::string& warning : outcome.warnings) ack.add_warnings(warning);
  peer_.send(MessageType::ack, ack);
}

void Requests::get_targets(const wire::GetTargets& request) {
  wire::TargetList list;
  list.set_request_id(id_);
  room_.targets().expire();
  room_.targets().write(request.after(), list);
  peer_.send(MessageType::target_list, list);
}

}  // namespace obliq::net
