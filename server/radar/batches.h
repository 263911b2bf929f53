#pragma once
// What the stages of the pipeline pass on: structures of arrays, filled up to `n`.
#include <array>
#include <cstdint>

#include "server/scene/embree_tracer.h"
#include "server/scene/exact_hit.h"

namespace obliq {

constexpr int kBatch = 1024;  ///< rays a batch: 64 packets, which stay in the first-level caches

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

/// Visible pieces of surface, from any source. Nothing here or after it knows of pixels.
struct SampleBatch {
  int n = 0;
  std::array<std::int32_t, kBatch> azimuth_bin;
  std::array<double, kBatch> slant_range_m;
  std::array<double, kBatch> solid_angle_sr;
  std::array<double, kBatch> cos_incidence;  ///< 0..1
  std::array<double, kBatch>
      azimuth_offset_rad;  ///< clockwise from the sector's centre, for the antenna pattern
  std::array<double, kBatch> sin_elevation;
  std::array<double, kBatch> x_m;  ///< world position, for the ground cell
  std::array<double, kBatch> z_m;
  std::array<std::uint32_t, kBatch> face;  ///< building face, kNoFace on ground
  std::array<std::uint8_t, kBatch> material;
};

}  // namespace obliq
