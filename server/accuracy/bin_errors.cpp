#include "server/accuracy/bin_errors.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <stdexcept>
#include <vector>

namespace obliq {

namespace {

constexpr double kLitShare = 1e-3;      // of M: PAPER.md, definitions
constexpr double kVisibleShare = 0.01;  // of a building's solid angle and of its bin's power: the same place

/// Value below which a fraction of the values lies, linear between neighbours: the median of an even number
/// is the mean of the middle two. Reorders the values; 0 when there is none.
double quantile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0;
  const double place = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::ptrdiff_t>(place);
  const auto at = values.begin() + below;
  std::nth_element(values.begin(), at, values.end());
  const double low = *at;
  if (at + 1 == values.end()) return low;
  const double high = *std::min_element(at + 1, values.end());
  return low + (place - static_cast<double>(below)) * (high - low);
}

void require_planes(std::span<const double> power_w, std::span<const double> truth_w, int n_range) {
  if (n_range < 1 || power_w.size() != truth_w.size() ||
      power_w.size() % static_cast<std::size_t>(n_range) != 0)
    throw std::logic_error(fmt::format("bin_errors: planes of {} and {} bins with {} ranges", power_w.size(),
                                       truth_w.size(), n_range));
  const auto unfit = [](double w) { return !(w >= 0) || std::isinf(w); };
  if (std::any_of(power_w.begin(), power_w.end(), unfit) ||
      std::any_of(truth_w.begin(), truth_w.end(), unfit))
    throw std::logic_error("bin_errors: a power is negative, infinite or no number");
}

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

BinErrors bin_errors(std::span<const double> power_w, std::span<const double> truth_w,
                     const RangeBins& ranges) {
  require_planes(power_w, truth_w, ranges.n_range);
  const auto n_range = static_cast<std::size_t>(ranges.n_range);
  const auto q_of = [&](std::size_t k) { return ranges.q(static_cast<int>(k % n_range), truth_w[k]); };
  BinErrors errors;
  errors.bins = truth_w.size();

  std::vector<double> values;
  for (std::size_t k = 0; k < truth_w.size(); ++k)
    if (truth_w[k] > 0) values.push_back(q_of(k));
  errors.median_q = quantile(values, 0.5);

  values.clear();  // from here on |10 log10 P/T|
  double squares = 0;
  double weights = 0;
  double relative = 0;
  for (std::size_t k = 0; k < truth_w.size(); ++k) {
    const double p = power_w[k];
    const double t = truth_w[k];
    errors.energy_w += p;
    errors.truth_energy_w += t;
    if (t == 0) {
      ++errors.dark;
      if (p > 0) {
        ++errors.false_light;
        errors.false_light_w += p;
      }
      continue;
    }
    const double q = q_of(k);
    if (q < kLitShare * errors.median_q) {
      ++errors.dont_care;
      continue;
    }
    ++errors.lit;
    const double off = p / t - 1;
    squares += q * q * (off * off);
    weights += q * q;
    relative += std::min(std::abs(off), 1.0);
    if (p > 0)
      values.push_back(std::abs(10 * std::log10(p / t)));
    else
      ++errors.gaps;
  }
  if (errors.lit > 0) {
    errors.power_error = std::sqrt(squares / weights);
    errors.mean_relative = relative / static_cast<double>(errors.lit);
  }
  errors.median_db = quantile(values, 0.5);
  errors.percentile95_db = quantile(values, 0.95);
  return errors;
}

bool truth_sees_building(double visible_sr, double unoccluded_sr, double largest_share) {
  return visible_sr > 0 && visible_sr >= kVisibleShare * unoccluded_sr && largest_share >= kVisibleShare;
}

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
