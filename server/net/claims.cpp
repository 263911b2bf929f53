#include "server/net/claims.h"

#include "server/net/peer.h"

namespace obliq::net {

using wire::Claim;
using wire::claim_bit;
using wire::ClaimSet;
using wire::for_each_claim;

ClaimSet Claims::of(const Peer& peer) const {
  ClaimSet held = 0;
  for_each_claim(wire::kAllClaims, [&](Claim claim) {
    if (holder(claim) == &peer) held |= claim_bit(claim);
  });
  return held;
}

ClaimSet Claims::taken(ClaimSet claims, const Peer* by_other_than) const {
  ClaimSet others = 0;
  for_each_claim(claims, [&](Claim claim) {
    if (holder(claim) != nullptr && holder(claim) != by_other_than) others |= claim_bit(claim);
  });
  return others;
}

void Claims::give(ClaimSet claims, Peer& peer) {
  for_each_claim(claims, [&](Claim claim) { holders_[static_cast<std::size_t>(claim)] = &peer; });
}

ClaimSet Claims::release(ClaimSet claims, const Peer& peer) {
  const auto released = static_cast<ClaimSet>(claims & of(peer));
  for_each_claim(released, [&](Claim claim) { holders_[static_cast<std::size_t>(claim)] = nullptr; });
  return released;
}

std::string Claims::sentence(ClaimSet claims, const Peer* by_other_than) const {
  std::string text;
  for (ClaimSet left = taken(claims, by_other_than); left != 0;) {
    const Peer* other = nullptr;
    for_each_claim(left, [&](Claim claim) { other = other == nullptr ? holder(claim) : other; });
    const auto its = static_cast<ClaimSet>(left & of(*other));
    const std::string verb = its == wire::kPoseClaim ? " is" : " are";
    text +=
        text.empty() ? wire::claim_names(its) + verb + " held by " : ", " + wire::claim_names(its) + " by ";
    text += other->name;
    left = static_cast<ClaimSet>(left & ~its);
  }
  return text;
}

}  // namespace obliq::net
