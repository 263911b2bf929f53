#pragma once
// [flight]: how the daemon moves its loaded terrain with radars that fly.

namespace obliq {

struct Section;

/// How the daemon moves its loaded terrain with radars that fly.
struct FlightConfig {
  bool enabled = true;
  double reorigin_km = 20;  ///< the origin moves to the first radar when it is further than this from it
  double max_reach_km = 0;  ///< what is loaded around a radar is never for more range; 0: its r_max at start
  double max_megaposts = 64;  ///< a larger window is not loaded while serving
};

extern const Section kFlightSection;

}  // namespace obliq
