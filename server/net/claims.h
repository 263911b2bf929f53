#pragma once
#include <array>
#include <optional>
#include <string>

#include "proto/claim.h"

namespace obliq::net {

class Peer;

/// Which client holds what of one radar. On the io thread.
class Claims {
 public:
  Peer* holder(wire::Claim claim) const { return holders_[static_cast<std::size_t>(claim)]; }
  /// What this client holds.
  wire::ClaimSet of(const Peer& peer) const;
  bool holds(const Peer& peer, wire::ClaimSet claims) const { return (of(peer) & claims) == claims; }
  /// What of the set another client holds.
  wire::ClaimSet taken(wire::ClaimSet claims, const Peer* by_other_than) const;
  bool is_any_held() const { return taken(wire::kEveryClaim, nullptr) != 0; }

  void give(wire::ClaimSet claims, Peer& peer);
  /// Those of the set that this client held.
  wire::ClaimSet release(wire::ClaimSet claims, const Peer& peer);

  /// "pose is held by X, settings by Y", of what others hold of the set; empty: nothing.
  std::string sentence(wire::ClaimSet claims, const Peer* by_other_than) const;

 private:
  std::array<Peer*, wire::kClaims> holders_{};
};

}  // namespace obliq::net
