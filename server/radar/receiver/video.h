#pragma once
#include "server/radar/settings.h"

namespace obliq {

struct VideoScale {
  double floor_db = 0;   ///< of level 1, in dB re the unit of power
  double span_db = 100;  ///< to the highest level
};

/// Where the video's scale begins, in dB re the unit of power: video.floor_db, or, if that is automatic and
/// rounded down to a whole dB, the noise before gain and sensitivity time control (at r_max where ranges are
/// normalised); without noise 20 dB below the mean return of level ground of gamma -15 dB at r_max, seen from
/// r_max / 20 above it. Of settings alone.
double video_floor_db(const RadarSettings& settings);

/// The mean return of level ground of constant gamma in an azimuth and range bin at a slant range, in watts:
/// K G^2 gamma w h delta / r^4 (the ground's solid angle in a bin is w h delta / r^2).
double level_ground_power_w(const RadarSettings& settings, double gamma_db, double slant_range_m,
                            double height_m);

/// Whether video follows from I&Q: of one look. Of more it follows from the mean power.
inline bool video_needs_iq(const RadarSettings& settings) { return settings.video.looks == 1; }

/// Levels of a plane with so many bits, 8 or 16: 0 to this less one.
constexpr int video_levels(int bits) { return 1 << bits; }

}  // namespace obliq
