#pragma once
// The plane that a display shows: powers as levels.
#include <cstdint>
#include <span>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/receiver/weather.h"
#include "server/radar/settings.h"

namespace obliq {

/// What makes levels of powers.
struct VideoScale {
  double floor_db = 0;   ///< of level 1, in dB re the unit of power
  double span_db = 100;  ///< to the highest level
  int ftc_bins = 0;      ///< of a fast time constant; 0: none
};
VideoScale video_scale(const RadarSettings& settings, const AirView& air = {});

/// A fast time constant: what a power has above the mean of the last `bins` range bins, its own included (of
/// those that there are near r_min), and 0 where it has nothing. Rain, which is even in range, goes; edges
/// stay.
void take_mean_away(std::span<double> power, int bins);

/// Where the video's scale begins, in dB re the unit of power: video.floor_db, or, if that is automatic and
/// rounded down to a whole dB, the noise before gain and sensitivity time control (at r_max where ranges are
/// normalised); without noise 20 dB below the mean return of level ground of gamma -15 dB at r_max, seen from
/// r_max / 20 above it. Of settings alone, but for the noise of an image of synthetic aperture.
double video_floor_db(const RadarSettings& settings, const AirView& air = {});

/// The mean return of level ground of constant gamma in an azimuth and range bin at a slant range, in watts:
/// K G^2 gamma w h delta / r^4 (the ground's solid angle in a bin is w h delta / r^2).
double level_ground_power_w(const RadarSettings& settings, double gamma_db, double slant_range_m,
                            double height_m);

/// Whether video follows from I&Q: of one look. Of more it follows from the mean power.
inline bool video_needs_iq(const RadarSettings& settings) { return settings.video.looks == 1; }

/// Writes the video of bins, a row at a time: all video is made here. For one thread at a time.
class VideoCoder {
 public:
  /// Makes room in the planes that are wanted; one that is not stays as it is.
  VideoCoder(const VideoScale& scale, bool video8, bool video16, BinBlock& bins);

  /// [n_range], to be filled: finite, 0 or more, in the unit of power.
  double* power() { return power_.data(); }
  /// Writes their levels as the row of an azimuth bin of the block.
  void code(int azimuth);

 private:
  template <typename Level>
  void code(std::size_t first, std::vector<Level>& plane);

  VideoScale scale_;
  bool video8_, video16_;
  BinBlock& bins_;
  std::vector<double> power_;        ///< with what the kernel reads beyond
  std::vector<std::int32_t> level_;  ///< as long
};

/// The video of one look follows from I&Q.
void add_video_of_iq(const VideoScale& scale, bool video8, bool video16, BinBlock& bins);

}  // namespace obliq
