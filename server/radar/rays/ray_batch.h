#pragma once
// Rays of a wedge and what they hit first, a batch at a time.
#include <array>
#include <cmath>
#include <cstdint>

#include "server/radar/bins.h"
#include "server/radar/samples.h"
#include "server/radar/simd/ground/rays.h"

namespace obliq {

/// Rays from the antenna, world axes, unit directions.
struct RayBatch {
  int n = 0;
  std::array<double, kBatch> dir_x;
  std::array<double, kBatch> dir_y;
  std::array<double, kBatch> dir_z;
  std::array<double, kBatch> solid_angle_sr;
  std::array<std::int32_t, kBatch> azimuth_bin;
  std::array<std::uint32_t, kBatch> pixel;  ///< row * columns + column, for textures alone
  std::array<std::uint16_t, kBatch>
      packet_order;  ///< every ray once: sixteen after another are traced together

  bool full() const { return n == kBatch; }
};

/// What each ray of a batch hits first, in double precision.
struct HitBatch : GroundHits {
  std::array<std::uint32_t, kBatch> face;  ///< kNoFace on ground
  std::array<std::uint8_t, kBatch> material;
  std::array<float, kBatch> raster_gamma;

  /// False: the ray meets nothing, and its other values mean nothing.
  bool is_hit(std::size_t k) const { return !std::isnan(slant_range_m[k]); }
};

/// A ray's hit as one sample with the pixel's whole solid angle: a nearest plate.
inline Sample sample_at_hit(const BinGrid& bins, const RayBatch& rays, const HitBatch& hits, std::size_t k) {
  return {rays.azimuth_bin[k],
          hits.slant_range_m[k],
          rays.solid_angle_sr[k],
          hits.cos_incidence[k],
          bins.azimuth_edge_rad(rays.azimuth_bin[k] + 0.5),
          rays.dir_y[k],
          hits.x_m[k],
          hits.z_m[k],
          hits.face[k],
          hits.material[k],
          hits.raster_gamma[k]};
}

}  // namespace obliq
