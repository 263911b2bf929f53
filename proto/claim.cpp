#include "proto/claim.h"

namespace obliq::wire {

const char* claim_name(Claim claim) {
  switch (claim) {
    case Claim::pose:
      return "pose";
    case Claim::settings:
      return "settings";
    case Claim::targets:
      return "targets";
  }
  return "?";
}

std::string claim_names(ClaimSet claims) {
  std::string names;
  for_each_claim(
      claims, [&](Claim claim) { names += (names.empty() ? "" : " and ") + std::string(claim_name(claim)); });
  return names;
}

std::optional<Claim> claim_from_number(int number) {
  if (number < 0 || number >= kClaims) return std::nullopt;
  return static_cast<Claim>(number);
}

}  // namespace obliq::wire
