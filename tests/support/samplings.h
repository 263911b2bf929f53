#pragma once
// Every way the product can sample a scene: a new one is one line here, and every test that asks for all of
// them has it.
#include "server/radar/settings.h"

namespace obliq::test {

struct Sampling {
  const char* name;
  FrustumKind frustum;
  PlateKind plates = PlateKind::spread;  ///< rays only

  /// Casts one ray a pixel, laid out whatever the bins and the buildings are.
  bool rays() const { return frustum != FrustumKind::sweep; }
  /// Then every hit is one sample, exactly where the ray met the surface.
  bool one_sample_a_ray() const { return rays() && plates == PlateKind::nearest; }
};

inline constexpr Sampling kSamplings[] = {
    {"symmetric", FrustumKind::symmetric},
    {"oblique", FrustumKind::oblique},
    {"sweep", FrustumKind::sweep},
    {"symmetric, nearest bin", FrustumKind::symmetric, PlateKind::nearest},
    {"oblique, nearest bin", FrustumKind::oblique, PlateKind::nearest},
};

/// The settings with one way of sampling.
inline RadarSettings sampled(RadarSettings settings, const Sampling& sampling) {
  settings.frustum = sampling.frustum;
  settings.plates = sampling.plates;
  return settings;
}

}  // namespace obliq::test
