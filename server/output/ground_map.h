#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "server/radar/bins.h"

namespace obliq::wire {
class FrameDescriptor;
}

namespace obliq {

/// The bins re-mapped to a Cartesian plane: azimuthal equidistant metres around the antenna.
/// Slant range becomes ground range over the effective earth at the frame's reference height.
struct GroundMap {
  int width = 0;
  int height = 0;
  double pixel_m = 0;
  double left_m = 0;                 ///< east (or right) of the antenna, left edge of pixel column 0
  double top_m = 0;                  ///< north (or ahead) of the antenna, top edge of pixel row 0
  double antenna_above_m = 0;        ///< antenna above the reference height
  double up_rad = 0;                 ///< true bearing of the picture's up direction; 0 for north up
  bool of_power = false;             ///< magnitude_db is of the power, because the frame has no I&Q
  std::string unit;                  ///< of what magnitude_db is the level of, as the frame's descriptor says
  std::vector<float> magnitude_db;   ///< [height][width] 20 log10 |I&Q|, dB re unit; kNoValue where that is 0
  std::vector<float> slant_range_m;  ///< [height][width]
  std::vector<std::uint8_t> state;   ///< [height][width] BinState; kOutside off the sector
  static constexpr float kNoValue = -9999;
  static constexpr std::uint8_t kOutside = 255;
  static constexpr std::uint8_t kUnknown = 254;  ///< nothing came back, and the frame has no states
};

/// Whether there is something to see in them: I&Q or power.
bool can_be_drawn(const BinBlock& bins);

/// up_bearing_rad: true bearing that points up, 0 for a north-up map. Nearest bin, no interpolation. Planes
/// that the frame does not have may be empty.
GroundMap map_to_ground(const wire::FrameDescriptor& descriptor, const BinBlock& bins, double up_bearing_rad);

}  // namespace obliq
