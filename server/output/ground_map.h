#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/output/map_projection.h"
#include "server/radar/bins.h"

namespace obliq::wire {
class FrameDescriptor;
}  // namespace obliq::wire

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

struct GroundMapRequest {
  double up_rad = 0;          ///< true bearing that points up
  int side = 2048;            ///< pixels of the longer side, at most
  double least_pixel_m = 0;   ///< no finer than this
  bool with_antenna = false;  ///< the antenna's place is on the map, unless that makes it much larger
  const HeightGrid* ground = nullptr;  ///< in world coordinates: places are at its height
};

GroundMap map_to_ground(const MapProjection& projection, int n_azimuth, int n_range,
                        const GroundMapRequest& request);

/// How bright each bin is. Planes that the frame does not have may be empty.
struct BinLevels {
  std::vector<float> db;  ///< 20 log10 |I&Q|, dB re unit; kNoValue where that is 0
  std::string unit;       ///< as the frame's descriptor says
  bool of_power = false;  ///< 10 log10 of the power, because the frame has no I&Q
  bool of_video = false;  ///< of the video, because it has neither: dB re the unit of power
  static constexpr float kNoValue = -9999;
};

/// Whether there is something to see in them: I&Q, power or video.
bool can_be_drawn(const BinBlock& bins);

BinLevels bin_levels(const wire::FrameDescriptor& descriptor, const BinBlock& bins);

/// A bin's BinState; kUnknown where nothing came back and the frame has no states.
std::uint8_t state_of(const BinBlock& bins, const BinLevels& levels, std::size_t bin);
constexpr std::uint8_t kUnknownState = 254;

/// Writes a north-up map as a GeoTIFF in the azimuthal equidistant projection around the antenna (WGS84):
/// band 1 magnitude in dB (float32, nodata -9999), band 2 the bin state (255 outside the sector). `placed`
/// says in words how bins found their places. Throws InputError.
void write_ground_map_tif(const std::filesystem::path& path, const GroundMap& north_up, const BinBlock& bins,
                          const BinLevels& levels, const wire::FrameDescriptor& descriptor,
                          const std::string& placed);

}  // namespace obliq
