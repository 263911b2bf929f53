#pragma once
#include <array>
#include <cstdint>

#include "server/radar/samples.h"

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

}  // namespace obliq
