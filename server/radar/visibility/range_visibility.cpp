#include "server/radar/visibility/range_visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "server/radar/profile/ground_walk.h"
#include "server/radar/profile/horizon.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/profile/tile_walk.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "server/radar/visibility/range_march.h"
#include "server/scene/tolerances.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// A march that begins later saves less than finding the horizon there costs.
constexpr double kWorthwhile_cells = 64;
constexpr int kARoof = 10;  // its spans on a profile, in units of ask()

SinCos bearing_at(const ScenePlan& plan, double position) {
  const double bearing = plan.bearing_rad(position);
  return {std::sin(bearing), std::cos(bearing)};
}

/// The profile at a position, at the nadir.
Profile profile_at(const ScenePlan& plan, const VisibilityRequest& request, std::vector<RoofSpan>& spans) {
  const World& world = plan.scene().world();
  const glm::dvec3& antenna = plan.sector().antenna_m;
  Profile profile;
  profile.bearing = bearing_at(plan, request.position);
  if (!request.roofs) return profile;
  // A building that reaches across a bin's edge is in the lists of both bins.
  const int azimuth_bin = std::min(static_cast<int>(request.position), plan.bins().n_azimuth - 1);
  spans.clear();
  for (const std::uint32_t b : plan.buildings_in(azimuth_bin)) {
    ask(kARoof);
    add_roof_spans(world.buildings, b, antenna.x, antenna.z, profile.bearing.sin, profile.bearing.cos, spans);
  }
  profile.roofs = disjoint_roofs(spans);
  std::erase_if(profile.roofs, [](const RoofSpan& roof) { return !(roof.near_m < roof.far_m); });
  return profile;
}

/// All ground under and next to a roof.
bool is_known(const Scene& scene, const glm::dvec3& antenna_m, SinCos bearing, const RoofSpan& roof) {
  bool known = true;
  if (!scene.tiles().whole())
    over_tiles(scene.fine_tiles(), scene.world().grid, antenna_m, bearing, roof.near_m,
               roof.far_m + kMargin_m,
               [&](const TileBounds::Tile& tile, double, double) { known &= tile.whole; });
  return known;
}

/// The ground distance before which no surface of a profile lies in range bin `first` or beyond: slant range
/// squared is ground distance squared and height squared. 0 where that saves nothing, or where the horizon
/// there is more than ground and roofs.
double start_m(const ScenePlan& plan, const Profile& profile, int first) {
  const TileBounds& tiles = plan.scene().tiles();
  const double antenna_y_m = plan.sector().antenna_m.y;
  double highest_m = tiles.highest_m();
  for (const RoofSpan& roof : profile.roofs) {
    // No roofs are marched over unknown ground; under one, the horizon is straight up.
    if (!(roof.near_m > 0) || !is_known(plan.scene(), plan.sector().antenna_m, profile.bearing, roof))
      return 0;
    highest_m = std::max(highest_m, roof.roof_y_m);
  }
  const double height_m =
      std::max(std::abs(highest_m - antenna_y_m), std::abs(tiles.lowest_m() - antenna_y_m));
  const double range_m = plan.bins().r_min_m + first * plan.bins().range_spacing_m;
  if (!(range_m > height_m)) return 0;
  const double ground_m = std::sqrt((range_m - height_m) * (range_m + height_m)) - kMargin_m;
  return ground_m > kWorthwhile_cells * plan.scene().world().grid.cell_m ? ground_m : 0;
}

/// Of the ground up to a distance along all profiles.
HorizonBound ridge_of(const ScenePlan& plan, std::span<const VisibilityRequest> requests, double to_m) {
  const auto [least, most] = std::ranges::minmax(requests, {}, &VisibilityRequest::position);
  return {plan.scene(), plan.sector().antenna_m, bearing_at(plan, (least.position + most.position) / 2),
          (most.position - least.position) / 2 * plan.bins().azimuth_width_rad, to_m};
}

/// The horizon that a march from the nadir would have at a distance.
Horizon<double> horizon_at(const ScenePlan& plan, const HorizonBound& ridge, const Profile& profile,
                           double at_m) {
  const glm::dvec3& antenna = plan.sector().antenna_m;
  Horizon<double> horizon = ground_horizon(plan.scene(), ridge, antenna, profile.bearing, at_m);
  for (const RoofSpan& roof : profile.roofs) {
    if (!(roof.near_m < at_m)) break;
    horizon.raise(roof.near_m, roof.roof_y_m - antenna.y, true);
    horizon.raise(std::min(roof.far_m, at_m), roof.roof_y_m - antenna.y, true);
  }
  return horizon;
}

/// The walk of a profile from where surface may first lie in some bins to where none does any more.
GroundWalk walk_for(const ScenePlan& plan, const Profile& profile, double from_m, RangeWindow bins) {
  const BinGrid& grid = plan.bins();
  const double to_m = grid.r_min_m + (bins.last + 1) * grid.range_spacing_m + kMargin_m;
  return {
      plan.scene().world().grid,   plan.sector().antenna_m, profile.bearing.sin, profile.bearing.cos, from_m,
      std::min(to_m, grid.r_max_m)};
}

void finish(const ScenePlan& plan, Profile& profile, BinMarks& result) {
  RangeMarch(plan.bins(), plan.sector().antenna_m.y, profile.state, result).gap();
}

}  // namespace

int sub_azimuths_per_bin(const ScenePlan& plan) {
  const double arc_m = plan.bins().r_max_m * plan.bins().azimuth_width_rad;
  const double pairs = std::ceil(arc_m / plan.scene().world().grid.cell_m / 2);
  const int sub_azimuths = 2 * static_cast<int>(std::clamp(pairs, 1.0, 4.0));
  return sub_azimuths == 6 && plan.settings().frustum == FrustumKind::sweep ? 8 : sub_azimuths;
}

std::size_t first_bin_of_sub_azimuth(const ScenePlan& plan, int sub_azimuth, int sub_azimuths) {
  if (plan.settings().frustum != FrustumKind::sweep) return 0;
  // The centre of a column, (k + 1/2) / columns of the bin, is a profile of the sweep itself.
  const int halves = 2 * sweep_columns_per_bin(plan.settings()) * sub_azimuth;
  if (halves % sub_azimuths == 0 && halves / sub_azimuths % 2 == 1)
    return static_cast<std::size_t>(plan.bins().n_range);
  // The least of 2, 4 and 8 sub-azimuths that has this one.
  int least = sub_azimuths;
  while (least > 2 && sub_azimuth * (least / 2) % sub_azimuths == 0) least /= 2;
  if (least == 2) return 0;
  // Half as many stand a node apart at this range.
  const BinGrid& bins = plan.bins();
  const double from_m = least / 2 * plan.scene().world().grid.cell_m / bins.azimuth_width_rad;
  if (from_m < bins.r_min_m) return 0;
  const double bin = std::ceil((from_m - bins.r_min_m) / bins.range_spacing_m);
  return static_cast<std::size_t>(std::min(bin, static_cast<double>(bins.n_range)));
}

void mark_profiles(const ScenePlan& plan, std::span<const VisibilityRequest> requests,
                   std::span<BinMarks> results, std::vector<RoofSpan>& spans) {
  const BinGrid& bins = plan.bins();
  const HeightGrid& grid = plan.scene().world().grid;
  const glm::dvec3& antenna = plan.sector().antenna_m;
  std::vector<Profile> profiles;
  std::array<double, kMostProfiles> from_m{};
  for (std::size_t lane = 0; lane < requests.size(); ++lane) {
    profiles.push_back(profile_at(plan, requests[lane], spans));
    if (const int first = requests[lane].bins.first; first > 0)
      from_m[lane] = start_m(plan, profiles[lane], first);
  }
  std::optional<HorizonBound> ridge;
  if (const double farthest_m = std::ranges::max(from_m); farthest_m > 0)
    ridge = ridge_of(plan, requests, farthest_m);
  RangeProfiles lanes{};
  const auto next_roof = [&](std::size_t lane) {
    const Profile& profile = profiles[lane];
    lanes.roof_m[lane] = profile.roof < profile.roofs.size() ? profile.roofs[profile.roof].near_m : kInfinity;
  };
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(kMostProfiles); ++lane) {
    lanes.end_m[lane] = -1;
    if (lane >= requests.size()) continue;
    results[lane] = BinMarks(bins.n_range);
    Profile& profile = profiles[lane];
    if (from_m[lane] > 0) {
      profile.state.horizon = horizon_at(plan, *ridge, profile, from_m[lane]);
      while (profile.roof < profile.roofs.size() && profile.roofs[profile.roof].far_m <= from_m[lane])
        ++profile.roof;
    }
    const GroundWalk walk = walk_for(plan, profile, from_m[lane], requests[lane].bins);
    if (walk.done()) continue;
    set_out(lanes, lane, profile.bearing, walk);
    lanes.state[lane] = profile.state;
    lanes.visible[lane] = results[lane].visible.data();
    lanes.present[lane] = results[lane].present.data();
    next_roof(lane);
  }
  ask(static_cast<std::int64_t>(requests.size()) * bins.n_range);
  const GroundView ground = ground_view(grid, antenna);
  MarchedCells marched(lanes, grid);
  while (const unsigned at_roof = active_kernels().mark_visible_ranges(ground, bins, lanes)) {
    // Cells with roofs in them, a profile at a time.
    for (std::size_t lane = 0; lane < profiles.size(); ++lane) {
      if ((at_roof >> lane & 1) == 0) continue;
      Profile& profile = profiles[lane];
      profile.state = lanes.state[lane];
      GroundWalk walk(grid, antenna, profile.bearing.sin, profile.bearing.cos, lanes.d_m[lane],
                      lanes.end_m[lane]);
      RangeMarch marcher(bins, antenna.y, profile.state, results[lane]);
      ProfileSurface surface(profile, marcher, walk.at_m(), false);
      walk.advance(walk.end_m(), surface);
      stand_at(lanes, lane, walk);
      lanes.state[lane] = profile.state;
      next_roof(lane);
    }
    marched.ask_for_them();
  }
  marched.ask_for_them();
  for (std::size_t lane = 0; lane < profiles.size(); ++lane) {
    if (lanes.end_m[lane] < 0) continue;
    profiles[lane].state = lanes.state[lane];
    finish(plan, profiles[lane], results[lane]);
  }
}

}  // namespace obliq
