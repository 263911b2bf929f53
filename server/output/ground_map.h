#pragma once
#include <cstdint>
#include <vector>

#include "server/output/map_projection.h"

namespace obliq {
struct HeightGrid;

/// Which bin each place of a Cartesian plane around the antenna lies in (nearest bin, no interpolation).
/// Slant range becomes ground range over the effective earth at the frame's reference height, or, where the
/// ground is given, at the ground's own height.
struct GroundMap {
  int width = 0;
  int height = 0;
  double pixel_m = 0;
  double left_m = 0;  ///< east (or right) of the antenna, left edge of pixel column 0
  double top_m = 0;   ///< north (or ahead) of the antenna, top edge of pixel row 0
  double up_rad = 0;  ///< true bearing of the picture's up direction; 0 for north up
  /// [height][width] azimuth bin * range bins + range bin, or one of these.
  std::vector<std::uint32_t> bin;
  static constexpr std::uint32_t kOutside = 0xffffffff;  ///< off the sector
  static constexpr std::uint32_t kNoGround =
      0xfffffffe;  ///< in the sector's reach, where the ground is not known
  bool is_bin(std::size_t pixel) const { return bin[pixel] < kNoGround; }
};

struct GroundMapWish {
  double up_rad = 0;          ///< true bearing that points up
  int side = 2048;            ///< pixels of the longer side, at most
  double least_pixel_m = 0;   ///< no finer than this
  bool with_antenna = false;  ///< the antenna's place is on the map, unless that makes it much larger
  const HeightGrid* ground = nullptr;  ///< in world coordinates: places are at its height
};

GroundMap map_to_ground(const MapProjection& projection, int n_azimuth, int n_range,
                        const GroundMapWish& wish);

}  // namespace obliq
