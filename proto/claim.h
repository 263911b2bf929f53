#pragma once
// What of a radar, or of the world, one client at a time may hold. PROTOCOL.md, "Control".
#include <cstdint>
#include <optional>
#include <string>

namespace obliq::wire {

/// The numbers are those of the protobuf enumeration ClaimKind.
enum class Claim : std::uint8_t {
  pose = 0,      ///< where the antenna's platform is and how it lies
  settings = 1,  ///< the operator's knobs, and where the antenna looks from its platform
  targets = 2    ///< of the world, not of a radar
};
constexpr int kClaims = 3;

/// A set of claims, bit n for claim n.
using ClaimSet = std::uint8_t;
constexpr ClaimSet claim_bit(Claim claim) {
  return static_cast<ClaimSet>(1u << static_cast<unsigned>(claim));
}
constexpr ClaimSet kPoseClaim = claim_bit(Claim::pose);
constexpr ClaimSet kSettingsClaim = claim_bit(Claim::settings);
constexpr ClaimSet kTargetsClaim = claim_bit(Claim::targets);
constexpr ClaimSet kEveryClaim = kPoseClaim | kSettingsClaim;  ///< of a radar
constexpr ClaimSet kAllClaims = (1u << kClaims) - 1;
/// Of a client that names none: what version 1.1 knew.
constexpr ClaimSet kUnnamedClaims = kPoseClaim | kSettingsClaim;

/// Calls for each claim of a set, in the order of their numbers.
template <typename Call>
void for_each_claim(ClaimSet claims, Call call) {
  for (int i = 0; i < kClaims; ++i)
    if (const auto claim = static_cast<Claim>(i); claims & claim_bit(claim)) call(claim);
}

const char* claim_name(Claim claim);
/// "pose and settings", as far as they are in the set.
std::string claim_names(ClaimSet claims);

/// Nothing for a number that is no claim.
std::optional<Claim> claim_from_number(int number);

}  // namespace obliq::wire
