#include "server/radar/visibility/range_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/radar/profile/ground_walk.h"
#include "server/radar/profile/horizon.h"
#include "server/radar/profile/roof_steps.h"
#include "server/radar/profile/tile_walk.h"
#include "server/radar/profile/walking_planes.h"
#include "server/radar/simd/exact_math.h"
#include "server/radar/visibility/range_march.h"

namespace obliq {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A march that begins later saves less than finding the horizon there costs.
constexpr double kWorthwhile_cells = 64;
/// More than what a distance is rounded by.
constexpr double kSlack_m = 1e-3;

/// One vertical plane: its roofs and how far it has come.
struct Plane {
  SinCos bearing;
  std::vector<RoofStep> roofs;
  std::size_t roof = 0;
  ProfileState state;
};

/// Hands the ground of one plane to the marcher, cut at footprint edges, with roofs on top.
class Surface {
 public:
  /// Begins at from_m. to_end: on to the plane's end, else no farther than the roofs that have begun.
  Surface(Plane& plane, ProfileMarch& marcher, double from_m, bool to_end)
      : plane_(plane), marcher_(marcher), to_end_(to_end), from_m_(from_m), at_m_(from_m) {}

  void ground(const GroundPiece& piece) {
    if (plane_.roof < plane_.roofs.size()) {
      with_roofs(piece.d0_m, piece.d1_m, piece.start_m, piece.rise);
    } else {
      marcher_.piece(piece.d0_m, piece.start_m + piece.rise * piece.d0_m, piece.d1_m,
                     piece.start_m + piece.rise * piece.d1_m);
    }
    at_m_ = piece.d1_m;
  }
  void gap(double /*d0*/, double d1) {
    marcher_.gap();
    at_m_ = d1;
  }
  bool enough() {
    // The first cell may be one that ends where the walk begins.
    if (to_end_ || !(at_m_ > from_m_)) return false;
    while (plane_.roof < plane_.roofs.size() && plane_.roofs[plane_.roof].far_m <= at_m_) ++plane_.roof;
    return plane_.roof == plane_.roofs.size() || plane_.roofs[plane_.roof].near_m > at_m_;
  }

 private:
  /// Ground y = start + rise d on [d0, d1], replaced by roofs that stand above it.
  void with_roofs(double d0, double d1, double start, double rise) {
    const std::vector<RoofStep>& roofs = plane_.roofs;
    std::size_t& at = plane_.roof;
    double d = d0;
    while (d < d1) {
      while (at < roofs.size() && roofs[at].far_m <= d) ++at;
      double end = d1;
      bool roofed = false;
      if (at < roofs.size()) {
        roofed = roofs[at].near_m <= d;
        end = std::min(end, roofed ? roofs[at].far_m : roofs[at].near_m);
      }
      const double y0 = start + rise * d;
      const double y1 = start + rise * end;
      const double roof = roofed ? roofs[at].roof_y_m : -kInfinity;
      marcher_.piece(d, std::max(y0, roof), end, std::max(y1, roof));
      d = end;
    }
  }

  Plane& plane_;
  ProfileMarch& marcher_;
  bool to_end_;
  double from_m_;
  double at_m_;
};

SinCos bearing_at(const FramePlan& plan, double position) {
  const double bearing = plan.bearing_rad(position);
  return {std::sin(bearing), std::cos(bearing)};
}

/// The plane at a position, at the nadir.
Plane plane_at(const FramePlan& plan, double position, std::vector<FootprintSpan>& spans) {
  const World& world = plan.scene().world();
  const glm::dvec3& antenna = plan.sector().antenna_m;
  Plane plane;
  plane.bearing = bearing_at(plan, position);
  // A building that reaches across a bin's edge is in the lists of both bins.
  const int azimuth_bin = std::min(static_cast<int>(position), plan.bins().n_azimuth - 1);
  spans.clear();
  for (const std::uint32_t b : plan.buildings_in(azimuth_bin))
    footprint_spans(world.buildings, b, antenna.x, antenna.z, plane.bearing.sin, plane.bearing.cos, spans);
  plane.roofs = disjoint_roofs(world.buildings, spans);
  return plane;
}

void begin(const FramePlan& plan, ProfileResult& result) {
  result.visible.assign(static_cast<std::size_t>(plan.bins().n_range), 0);
  result.present.assign(static_cast<std::size_t>(plan.bins().n_range), 0);
}

/// All ground under and next to a roof.
bool is_known(const Scene& scene, const glm::dvec3& antenna_m, SinCos bearing, const RoofStep& roof) {
  bool known = true;
  if (!scene.tiles().whole())
    over_tiles(scene.fine_tiles(), scene.world().grid, antenna_m, bearing, roof.near_m, roof.far_m + kSlack_m,
               [&](const TileBounds::Tile& tile, double, double) { known &= tile.whole; });
  return known;
}

/// The ground distance before which no surface of a plane lies in range bin `first` or beyond: slant range
/// squared is ground distance squared and height squared. 0 where that saves nothing, or where the horizon
/// there is more than ground and roofs.
double start_m(const FramePlan& plan, const Plane& plane, int first) {
  const TileBounds& tiles = plan.scene().tiles();
  const double antenna_y_m = plan.sector().antenna_m.y;
  double highest_m = tiles.highest_m();
  for (const RoofStep& roof : plane.roofs) {
    // No roofs are marched over unknown ground; under one, the horizon is straight up.
    if (!(roof.near_m > 0) || !is_known(plan.scene(), plan.sector().antenna_m, plane.bearing, roof)) return 0;
    highest_m = std::max(highest_m, roof.roof_y_m);
  }
  const double height_m =
      std::max(std::abs(highest_m - antenna_y_m), std::abs(tiles.lowest_m() - antenna_y_m));
  const double range_m = plan.bins().r_min_m + first * plan.bins().range_spacing_m;
  if (!(range_m > height_m)) return 0;
  const double ground_m = std::sqrt((range_m - height_m) * (range_m + height_m)) - kSlack_m;
  return ground_m > kWorthwhile_cells * plan.scene().world().grid.cell_m ? ground_m : 0;
}

/// The horizon that a march from the nadir would have at a distance.
Horizon<double> horizon_at(const FramePlan& plan, const Plane& plane, double at_m) {
  const glm::dvec3& antenna = plan.sector().antenna_m;
  const GroundRidge ridge(plan.scene(), antenna, plane.bearing, 0, at_m);
  Horizon<double> horizon = ground_horizon(plan.scene(), ridge, antenna, plane.bearing, at_m);
  for (const RoofStep& roof : plane.roofs) {
    if (!(roof.near_m < at_m)) break;
    horizon.raise(roof.near_m, roof.roof_y_m - antenna.y, true);
    horizon.raise(std::min(roof.far_m, at_m), roof.roof_y_m - antenna.y, true);
  }
  return horizon;
}

/// Sets a plane where surface may first lie in some bins; the walk from there to where none does any more.
GroundWalk set_out_for(const FramePlan& plan, Plane& plane, RangeWindow bins) {
  const BinGrid& grid = plan.bins();
  const double from_m = bins.first > 0 ? start_m(plan, plane, bins.first) : 0;
  const double to_m =
      std::min(grid.r_max_m, grid.r_min_m + (bins.last + 1) * grid.range_spacing_m + kSlack_m);
  if (from_m > 0) {
    const Horizon<double> horizon = horizon_at(plan, plane, from_m);
    plane.state.horizon = horizon;
    while (plane.roof < plane.roofs.size() && plane.roofs[plane.roof].far_m <= from_m) ++plane.roof;
  }
  return {plan.scene().world().grid,   plan.sector().antenna_m, plane.bearing.sin, plane.bearing.cos, from_m,
          std::min(to_m, grid.r_max_m)};
}

void finish(const FramePlan& plan, Plane& plane, ProfileResult& result) {
  ProfileMarch(plan.bins(), plan.sector().antenna_m.y, plane.state, result).gap();
}

}  // namespace

int profile_strands(const FramePlan& plan) {
  const double arc_m = plan.bins().r_max_m * plan.bins().azimuth_width_rad;
  const double pairs = std::ceil(arc_m / plan.scene().world().grid.cell_m / 2);
  const int strands = 2 * static_cast<int>(std::clamp(pairs, 1.0, 4.0));
  return strands == 6 && plan.settings().frustum == FrustumKind::sweep ? 8 : strands;
}

std::size_t first_bin_of_strand(const FramePlan& plan, int strand, int strands) {
  if (plan.settings().frustum != FrustumKind::sweep) return 0;
  // The centre of a column, (k + 1/2) / columns of the bin, is a plane of the sweep itself.
  const int halves = 2 * sweep_columns_per_bin(plan.settings()) * strand;
  if (halves % strands == 0 && halves / strands % 2 == 1)
    return static_cast<std::size_t>(plan.bins().n_range);
  // The least of 2, 4 and 8 strands that has this one.
  int least = strands;
  while (least > 2 && strand * (least / 2) % strands == 0) least /= 2;
  if (least == 2) return 0;
  // Half as many stand a node apart at this range.
  const BinGrid& bins = plan.bins();
  const double from_m = least / 2 * plan.scene().world().grid.cell_m / bins.azimuth_width_rad;
  if (from_m < bins.r_min_m) return 0;
  const double bin = std::ceil((from_m - bins.r_min_m) / bins.range_spacing_m);
  return static_cast<std::size_t>(std::min(bin, static_cast<double>(bins.n_range)));
}

void march_profile(const FramePlan& plan, double position, std::vector<FootprintSpan>& spans,
                   ProfileResult& result) {
  const glm::dvec3& antenna = plan.sector().antenna_m;
  begin(plan, result);
  Plane plane = plane_at(plan, position, spans);
  GroundWalk walk(plan.scene().world().grid, antenna, plane.bearing.sin, plane.bearing.cos, 0,
                  plan.bins().r_max_m);
  if (walk.done()) return;
  ProfileMarch marcher(plan.bins(), antenna.y, plane.state, result);
  Surface surface(plane, marcher, walk.at_m(), true);
  walk.advance(walk.end_m(), surface);
  finish(plan, plane, result);
}

void march_profiles(const FramePlan& plan, std::span<const ProfileWish> wishes,
                    std::span<ProfileResult> results, std::vector<FootprintSpan>& spans,
                    const LaneKernels& kernels) {
  const BinGrid& bins = plan.bins();
  const HeightGrid& grid = plan.scene().world().grid;
  const glm::dvec3& antenna = plan.sector().antenna_m;
  std::vector<Plane> planes;
  ProfileLanes lanes{};
  const auto next_roof = [&](std::size_t lane) {
    const Plane& plane = planes[lane];
    lanes.roof_m[lane] = plane.roof < plane.roofs.size() ? plane.roofs[plane.roof].near_m : kInfinity;
  };
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(kMostProfiles); ++lane) {
    lanes.end_m[lane] = -1;
    if (lane >= wishes.size()) continue;
    begin(plan, results[lane]);
    Plane& plane = planes.emplace_back(plane_at(plan, wishes[lane].position, spans));
    const GroundWalk walk = set_out_for(plan, plane, wishes[lane].bins);
    if (walk.done()) continue;
    set_out(lanes, lane, plane.bearing, walk);
    lanes.state[lane] = plane.state;
    lanes.visible[lane] = results[lane].visible.data();
    lanes.present[lane] = results[lane].present.data();
    next_roof(lane);
  }
  const GroundView ground = ground_view(grid, antenna);
  while (const unsigned at_roof = kernels.march_profiles(ground, bins, lanes)) {
    // Cells with roofs in them, a plane at a time.
    for (std::size_t lane = 0; lane < planes.size(); ++lane) {
      if ((at_roof >> lane & 1) == 0) continue;
      Plane& plane = planes[lane];
      plane.state = lanes.state[lane];
      GroundWalk walk(grid, antenna, plane.bearing.sin, plane.bearing.cos, lanes.d_m[lane],
                      lanes.end_m[lane]);
      ProfileMarch marcher(bins, antenna.y, plane.state, results[lane]);
      Surface surface(plane, marcher, walk.at_m(), false);
      walk.advance(walk.end_m(), surface);
      stand_at(lanes, lane, walk);
      lanes.state[lane] = plane.state;
      next_roof(lane);
    }
  }
  for (std::size_t lane = 0; lane < planes.size(); ++lane) {
    if (lanes.end_m[lane] < 0) continue;
    planes[lane].state = lanes.state[lane];
    finish(plan, planes[lane], results[lane]);
  }
}

}  // namespace obliq
