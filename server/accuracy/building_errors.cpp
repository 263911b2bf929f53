#include "server/accuracy/building_errors.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "server/accuracy/bin_errors.h"

namespace obliq {
namespace {

/// Outlines in two worlds are the same when their centres are this near: the plumb line, followed to another
/// ground height, moves a house by millimetres.
constexpr double kSamePlace_m = 0.5;

struct Outline {
  glm::dvec2 centre_m{0.0};
  std::uint32_t corners = 0;
  std::uint32_t rings = 0;
};

Outline outline_of(const Buildings& buildings, const Building& building) {
  Outline outline;
  outline.rings = building.n_rings;
  const std::uint32_t first = buildings.ring_start[building.first_ring];
  const std::uint32_t end = buildings.ring_start[building.first_ring + building.n_rings];
  for (std::uint32_t k = first; k < end; ++k) outline.centre_m += glm::dvec2(buildings.ring_xz_m[k]);
  outline.corners = end - first;
  if (outline.corners > 0) outline.centre_m /= outline.corners;
  return outline;
}

using Place = std::pair<std::int64_t, std::int64_t>;

Place place_of(const glm::dvec2& p) {
  return {static_cast<std::int64_t>(std::floor(p.x / kSamePlace_m)),
          static_cast<std::int64_t>(std::floor(p.y / kSamePlace_m))};
}

}  // namespace

BuildingErrors missed_buildings(const std::vector<BuildingTruth>& truth,
                                const std::function<bool(std::uint32_t)>& seen) {
  BuildingErrors errors;
  for (std::uint32_t i = 0; i < truth.size(); ++i) {
    if (!truth_sees_building(truth[i].visible_sr, truth[i].unoccluded_sr, truth[i].largest_share)) continue;
    ++errors.visible;
    if (!seen(i)) ++errors.missed;
  }
  return errors;
}

std::vector<std::uint32_t> match_buildings(const Buildings& from, const Buildings& to) {
  std::multimap<Place, std::uint32_t> by_place;
  std::vector<Outline> outlines;
  for (std::uint32_t i = 0; i < to.list.size(); ++i) {
    outlines.push_back(outline_of(to, to.list[i]));
    by_place.emplace(place_of(outlines.back().centre_m), i);
  }
  std::vector<std::uint32_t> match;
  match.reserve(from.list.size());
  for (const Building& building : from.list) {
    const Outline wanted = outline_of(from, building);
    const Place here = place_of(wanted.centre_m);
    auto best = by_place.end();
    double nearest_m = kSamePlace_m;
    for (std::int64_t i = here.first - 1; i <= here.first + 1; ++i)
      for (std::int64_t j = here.second - 1; j <= here.second + 1; ++j) {
        const auto [first, last] = by_place.equal_range({i, j});
        for (auto it = first; it != last; ++it) {
          const Outline& found = outlines[it->second];
          const double distance_m = glm::distance(found.centre_m, wanted.centre_m);
          if (found.corners != wanted.corners || found.rings != wanted.rings || !(distance_m < nearest_m))
            continue;
          nearest_m = distance_m;
          best = it;
        }
      }
    match.push_back(best != by_place.end() ? best->second : kNoBuilding);
    if (best != by_place.end()) by_place.erase(best);  // two of the same outline are two
  }
  return match;
}

}  // namespace obliq
