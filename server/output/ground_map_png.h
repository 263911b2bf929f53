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

/// Keeps a stream's grey scale at that of the first frame that showed something, until the radar's settings
/// change: two pictures of it can be compared.
class SteadyScale {
 public:
  /// `given`: for all frames.
  explicit SteadyScale(std::optional<DbRange> given) : given_(given) {}
  /// For the next frame; nothing: whatever it shows.
  std::optional<DbRange> next(const wire::FrameDescriptor& descriptor);
  void drawn(std::optional<DbRange> scale) { kept_ = scale; }

 private:
  std::optional<DbRange> given_;
  std::optional<DbRange> kept_;
  std::string settings_;  ///< of the frames it was kept for
};

}  // namespace obliq
