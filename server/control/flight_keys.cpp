#include "server/control/flight_keys.h"

#include <array>

namespace obliq {
namespace {

using Scene = SceneConfig;
const std::array kFlight{
    Entry<Scene>{{"flight.enabled",
                  "",
                  {},
                  {},
                  "Load more terrain in the background when radars fly out of what is loaded."},
                 [](Scene& c) -> Slot { return &c.flight.enabled; }},
    Entry<Scene>{
        {"flight.reorigin_km",
         "km",
         closed(1, 100),
         {},
         "When the first radar is further than this from the scene's origin, the origin moves to it."},
        [](Scene& c) -> Slot { return &c.flight.reorigin_km; }},
    Entry<Scene>{{"flight.max_reach_km",
                  "km",
                  closed(0, 500),
                  {},
                  "Terrain is loaded for ranges up to this, whatever a client sets; 0: the longest r_max_m "
                  "in the scene file."},
                 [](Scene& c) -> Slot { return &c.flight.max_reach_km; }},
    Entry<Scene>{{"flight.max_megaposts",
                  "million",
                  above(0, 268),
                  {},
                  "Most posts of terrain to load while serving; they take 32 MB of memory per million, or 5 "
                  "MB where every frustum is polar or a sweep."},
                 [](Scene& c) -> Slot { return &c.flight.max_megaposts; }},
};

}  // namespace

std::span<const Entry<SceneConfig>> flight_entries() { return kFlight; }

}  // namespace obliq
