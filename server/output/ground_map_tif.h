#pragma once
#include <filesystem>

#include "server/output/bin_levels.h"
#include "server/output/ground_map.h"

namespace obliq {

/// Writes a north-up map as a GeoTIFF in the azimuthal equidistant projection around the antenna (WGS84):
/// band 1 magnitude in dB (float32, nodata -9999), band 2 the bin state (255 outside the sector). `placed`
/// says in words how bins found their places. Throws InputError.
void write_ground_map_tif(const std::filesystem::path& path, const GroundMap& north_up, const BinBlock& bins,
                          const BinLevels& levels, const wire::FrameDescriptor& descriptor,
                          const std::string& placed);

}  // namespace obliq
