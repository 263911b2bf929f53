#pragma once
// Requests of the recorded session, as text.
#include <string>

namespace obliq::test {

inline constexpr const char* kHigh = "height_m: 1500";
inline constexpr const char* kLow = "height_m: 2 height_reference: GROUND";

/// Fields of a RenderOnce. Frusta of traced rays only where they are refused: their bits would depend on the
/// version of Embree.
inline std::string once(const std::string& settings, const std::string& more = "",
                        const std::string& height = kHigh) {
  return "radar: 'alone' settings { sector_deg: 60 r_min_m: 2000 r_max_m: 6000 pixel_columns: 64 "
         "pixel_rows: 48 azimuth_bins: 16 range_bins: 24 " +
         settings + "} pose { latitude_deg: 33 longitude_deg: -99.5 bearing_deg: 10 " + height + "} " + more;
}

/// Fields of a Subscribe: one frame at once, the next in a quarter of an hour.
inline std::string watch(const std::string& radar, const std::string& more = "") {
  return "radar: '" + radar + "' rate_hz: 0.001 " + more;
}

inline constexpr const char* kMain = "radar: 'main'";

}  // namespace obliq::test
