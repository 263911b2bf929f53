#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "server/output/picture_caption.h"
#include "server/radar/bins.h"

namespace obliq {

/// Which way a picture points.
enum class MapUp { bearing, north };

struct PictureOptions {
  MapUp up = MapUp::bearing;
  int side = 1400;                  ///< pixels of the map's longer side
  std::optional<DbRange> db_range;  ///< without: chosen by what there is to see
  std::string time;                 ///< without: the pose's own, where it has one
};

/// Draws a frame as a display would: brightness in dB, outline, rings, bearings, antenna, caption. For
/// display only, magnitude is multiplied by r^2 (sensitivity time control) unless the frame is already
/// normalised. The grey scale spans the 5th to the 99.7th percentile of what is seen, in whole decibels,
/// unless db_range gives it; the one that was used comes back (as it was given where there is nothing to
/// see). `descriptor` is that of the window, as placed_window() gives it. Throws InputError.
std::optional<DbRange> write_ground_map_png(const std::filesystem::path& path,
                                            const wire::FrameDescriptor& descriptor,
                                            const wire::FrameSummary& summary, const BinBlock& bins,
                                            const PictureOptions& options);

}  // namespace obliq
