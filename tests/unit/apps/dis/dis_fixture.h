#pragma once
// PDUs of DIS as bytes and as states, for tests.
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numbers>
#include <string_view>
#include <vector>

#include "server/apps/dis/entity_state.h"

namespace obliq::test {

constexpr double kDegree = std::numbers::pi / 180;

/// Metres from the earth's centre (WGS84), written out: independent of the library that the code asks.
inline glm::dvec3 earth_centred(double latitude_deg, double longitude_deg, double height_m) {
  constexpr double kRadius_m = 6378137.0, kFlattening = 1 / 298.257223563;
  const double square = kFlattening * (2 - kFlattening);
  const double phi = latitude_deg * kDegree, lambda = longitude_deg * kDegree;
  const double n = kRadius_m / std::sqrt(1 - square * std::sin(phi) * std::sin(phi));
  return {(n + height_m) * std::cos(phi) * std::cos(lambda),
          (n + height_m) * std::cos(phi) * std::sin(lambda), (n * (1 - square) + height_m) * std::sin(phi)};
}

inline std::vector<std::byte> bytes_of(std::string_view hex) {
  std::vector<std::byte> bytes;
  const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  for (std::size_t k = 0; k + 1 < hex.size(); k += 2)
    bytes.push_back(static_cast<std::byte>(16 * digit(hex[k]) + digit(hex[k + 1])));
  return bytes;
}

/// An Entity State PDU of another implementation, 160 bytes with one variable parameter: exercise 42,
/// absolute timestamp 34 min 56.789 s past the hour, entity 11:22:33, force 2, type 1.2.225.85.11.7.3,
/// velocity 250, -3.5, 1.25, place 36.41 N 107.58 W 2,500 m, psi, theta, phi 0.5, -0.25, 0.125, frozen,
/// algorithm 4, acceleration 1.5, 2.5, -0.5, turn 0.01, -0.02, 0.03, marking "OWL 7".
inline std::vector<std::byte> entity_bytes() {
  return bytes_of(
      "072a0101951ae0ff00a00000000b001600210201010200e1550b07030000000000000000437a0000c06000003fa00000"
      "c137b1aeb182c0eac152b228cf2eb67e414cbc38cdd8a4873f000000be8000003e000000002000000400000000000000"
      "00000000000000003fc0000040200000bf0000003c23d70abca3d70a3cf5c28f014f574c203700000000000000000009"
      "003ff000000000000000000002000304");
}

/// Over 33 N 99.5 W, 2,000 m up, of type 1.2.225.1, algorithm 2.
inline EntityState entity(std::uint16_t number = 1) {
  EntityState state;
  state.id = {1, 2, number};
  state.type = {1, 2, 225, 1, 0, 0, 0};
  state.location_m = earth_centred(33.0, -99.5, 2000.0);
  state.dead_reckoning = 2;
  return state;
}

}  // namespace obliq::test
