#pragma once
// Every way the product can sample a scene: a new one is one line here, and every test that asks for all of
// them has it.
#include "server/radar/settings.h"

namespace obliq::test {

struct Sampling {
  const char* name;
  FrustumKind frustum;

  bool perspective() const { return frustum == FrustumKind::symmetric || frustum == FrustumKind::oblique; }
  /// Casts one ray a pixel, laid out whatever the bins and the buildings are.
  bool rays() const { return perspective() || frustum == FrustumKind::polar; }
};

inline constexpr Sampling kSamplings[] = {
    {"symmetric", FrustumKind::symmetric},
    {"oblique", FrustumKind::oblique},
    {"polar", FrustumKind::polar},
    {"sweep", FrustumKind::sweep},
};

/// The settings with one way of sampling.
inline RadarSettings sampled(RadarSettings settings, const Sampling& sampling) {
  settings.frustum = sampling.frustum;
  return settings;
}

}  // namespace obliq::test
