#include "server/control/sections/flight.h"

#include <array>

#include "server/control/sections/section.h"

namespace obliq {
namespace {

using Flight = RowsOf<Change::reload, &SceneConfig::flight>;
constexpr std::array kRows{
    Flight::row<&FlightConfig::enabled>(
        "flight.enabled", "Load more terrain in the background when radars fly out of what is loaded."),
    Flight::row<&FlightConfig::reorigin_km>(
        "flight.reorigin_km", "km", closed(1, 100),
        "When the first radar is further than this from the scene's origin, the origin moves to it."),
    Flight::row<&FlightConfig::max_reach_km>(
        "flight.max_reach_km", "km", closed(0, 500),
        "Terrain is loaded for ranges up to this, whatever a client sets; 0: the longest r_max_m "
        "in the scene file."),
    Flight::row<&FlightConfig::max_megaposts>(
        "flight.max_megaposts", "million", above(0, 268),
        "Most posts of terrain to load while serving; they take 32 MB of memory per million, or 5 "
        "MB where every frustum is a sweep."),
};

}  // namespace

const Section kFlightSection{"flight", {kRows}, nullptr, true};

}  // namespace obliq
