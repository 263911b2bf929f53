#pragma once
// Every way the product can sample a scene: a new one is one line here, and every test that asks for all of
// them has it.
#include "server/radar/settings.h"

namespace obliq::test {

struct Sampling {
  const char* name;
  FrustumKind frustum;
  PlateKind plates = PlateKind::spread;  ///< rays only

  bool perspective() const { return frustum == FrustumKind::symmetric || frustum == FrustumKind::oblique; }
  /// Casts one ray a pixel, laid out whatever the bins and the buildings are.
  bool rays() const { return perspective() || frustum == FrustumKind::polar; }
  /// Then every hit is one sample, exactly where the ray met the surface.
  bool one_sample_a_ray() const { return rays() && plates == PlateKind::nearest; }
};

inline constexpr Sampling kSamplings[] = {
    {"symmetric", FrustumKind::symmetric},
    {"oblique", FrustumKind::oblique},
    {"polar", FrustumKind::polar},
    {"sweep", FrustumKind::sweep},
    {"symmetric, nearest bin", FrustumKind::symmetric, PlateKind::nearest},
    {"oblique, nearest bin", FrustumKind::oblique, PlateKind::nearest},
    {"polar, nearest bin", FrustumKind::polar, PlateKind::nearest},
};

/// The settings with one way of sampling.
inline RadarSettings sampled(RadarSettings settings, const Sampling& sampling) {
  settings.frustum = sampling.frustum;
  settings.plates = sampling.plates;
  return settings;
}

}  // namespace obliq::test
