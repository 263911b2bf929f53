#pragma once
// What tests of modes that look at Doppler have in common.
#include <vector>

#include "tests/support/same_bits.h"
#include "tests/support/target_scenes.h"

namespace obliq::test {

/// X band, a beam of 3 degrees, 64 range bins around 6 km.
inline RadarSettings doppler_radar(RadarMode mode, int azimuth_bins, double sector_deg = 40) {
  RadarSettings s =
      radar_settings(FrustumKind::sweep, {5000, 7000, sector_deg}, {azimuth_bins, 64}, {azimuth_bins, 1});
  s.mode = mode;
  s.frequency_ghz = 9.4;
  s.speckle = SpeckleKind::ground;
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = 3;
  s.beam.extent_deg = 8;
  return s;
}

/// The first is the sea.
inline std::vector<Material> sea_materials() {
  std::vector<Material> materials = two_materials();
  materials[0].model = ScatteringModel::sea;
  materials[0].gamma = 1e-4;
  return materials;
}

/// Level ground of material `left` to the left of the middle, and of the other of two to its right.
inline World shore(std::uint8_t left) {
  World world = level_world();
  const int nx = world.grid.nx - 1, nz = world.grid.nz - 1;
  for (int j = 0; j < nz; ++j)
    for (int i = 0; i < nx; ++i)
      world.surface_material.push_back(static_cast<std::uint8_t>(i < nx / 2 ? left : 1 - left));
  return world;
}

/// A frame on one thread, which is the same on three and in parts.
inline Frame same_frame_in_any_parts(const TargetScene& scene, const RadarSettings& s) {
  const Frame one = scene.render(s, {}, 1);
  expect_same_bits(one.bins, scene.render(s, {}, 3).bins);
  BinBlock again = one.bins;
  copy_azimuths(scene.part(s, {}, {80, 24}).bins, again);
  expect_same_bits(one.bins, again);
  return one;
}

/// Of all ranges.
inline double azimuth_power(const BinBlock& bins, int azimuth) {
  double total = 0;
  for (int m = 0; m < bins.n_range; ++m)
    total += bins.power_w[static_cast<std::size_t>(azimuth * bins.n_range + m)];
  return total;
}

}  // namespace obliq::test
