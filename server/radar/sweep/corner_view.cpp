#include "server/radar/sweep/corner_view.h"

#include <algorithm>
#include <cmath>

#include "terrain/base/asking.h"
#include "terrain/ground_slope.h"

namespace obliq {
namespace {

constexpr int kAFoot = 8;  // in units of ask()

/// Ground that lies so far below the horizon before it counts as lit: floats keep a slope to 1e-7.
constexpr double kShallow_m = 0.01;

/// Of the strip that level ground before a wall would give.
constexpr double kMostPieces = 4;

/// A piece is divided where the lobe's tangent turns by more than this share of the rms slope.
constexpr double kLobeStep = 0.25;
constexpr double kMostSteps = 64;

/// How far before a foot the shadow of buildings ends, on ground that rises by `rise` a metre towards the
/// antenna.
double to_shade_m(const CornerView::Foot& foot, double down, double rise) {
  const double steeper = -foot.shade - rise;
  return steeper > 0 ? foot.distance_m * (-foot.shade - down) / steeper : HUGE_VAL;
}

}  // namespace

void CornerView::add(const Foot& foot, const NodeProfiles& nodes) {
  const double down = -foot.ground_m / foot.distance_m;  // tangent of the depression
  const double height_m = foot.roof_m - foot.ground_m;
  const double across = -(foot.normal_x * foot.bearing.sin + foot.normal_z * foot.bearing.cos);
  const double along = foot.normal_x * foot.bearing.cos - foot.normal_z * foot.bearing.sin;
  if (!(down > 0 && height_m > 0 && across > 0) || !table_->may_shine(along / down)) return;
  // Where the shadow of what stands before ends, at the least.
  if (foot.shade >= -down) return;
  ask(kAFoot);

  // The ground that takes part lies before the foot in the direction that the wall mirrors, in pieces of a
  // cell or of a share of the strip that level ground would give.
  const HeightGrid& grid = plan_.scene().world().grid;
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const glm::dvec3 foot_m(antenna.x + foot.distance_m * foot.bearing.sin, antenna.y + foot.ground_m,
                          antenna.z + foot.distance_m * foot.bearing.cos);
  const double mirrored_x = 2 * across * foot.normal_x + foot.bearing.sin;
  const double mirrored_z = 2 * across * foot.normal_z + foot.bearing.cos;
  const double level_m = std::min(height_m / down, to_shade_m(foot, down, 0));
  const double piece_m = std::max(level_m / kMostPieces, std::min(level_m, grid.cell_m));
  double end_m = 2 * level_m;
  for (int k = 0; k * piece_m < end_m; ++k) {
    const double from_m = k * piece_m;
    const double middle_m = from_m + piece_m / 2;
    const double x = foot_m.x + middle_m * mirrored_x;
    const double z = foot_m.z + middle_m * mirrored_z;
    const GroundSlope under = ground_slope_at(grid, x, z);
    if (!under.known) return;
    const FootSlope slope{under.per_x * foot.normal_x + under.per_z * foot.normal_z,
                          under.per_x * foot.normal_z - under.per_z * foot.normal_x};
    // Towards the antenna the ground rises by `rise` a metre, in the mirrored direction by `gain`.
    const double rise = slope.across * across + slope.along * along;
    const double gain = slope.across * across - slope.along * along;
    if (k == 0) end_m = lit_m(foot, nodes, std::min(end_m, to_shade_m(foot, down, rise)));
    const double h = grid.height_at_m(x, z) - antenna.y;
    // The ray to the antenna's image meets the wall below the roof.
    const double room_m = foot.roof_m * (1 + from_m / foot.distance_m) - (h - gain * piece_m / 2);
    const double closing = gain - foot.roof_m / foot.distance_m;
    double length_m = std::min(piece_m, end_m - from_m);
    if (closing > 0) length_m = std::min(length_m, room_m / closing);
    if (!(length_m > 0 && down + rise > 0)) return;

    const double before = (from_m + length_m / 2) / foot.distance_m;
    const double down_there = -(h + gain * (length_m - piece_m) / 2) / foot.distance_m;
    const CornerSight sight = CornerSight::over_ground(across, along, down, before, down_there);
    const std::uint8_t ground = plan_.scene().world().material_of_cell(under.i, under.j);
    // Rays spread on their way from the wall over the strip.
    const double area_m2 = foot.width_rad * foot.distance_m * (1 + before) * length_m *
                           std::sqrt(1 + slope.across * slope.across + slope.along * slope.along);
    if (const double lobe = mean_lobe(foot, ground, sight, slope); lobe > 0)
      share_out(foot, {foot.face, 0, foot.material, ground, lobe * area_m2, sight.across, 0, foot_m});
    if (length_m < piece_m) return;
  }
}

/// The lobe across the piece.
double CornerView::mean_lobe(const Foot& foot, std::uint8_t ground, const CornerSight& sight,
                             const FootSlope& slope) const {
  const double turn = foot.width_rad * sight.across / sight.up;
  const double n = std::clamp(std::ceil(turn / (kLobeStep * table_->narrowest_slope())), 1.0, kMostSteps);
  if (n == 1) return table_->lobe(ground, sight, slope);
  double sum = 0;
  for (double k = 0.5; k < n; ++k) {
    const double off = (k / n - 0.5) * foot.width_rad;
    sum +=
        table_->lobe(ground, {sight.across, sight.along + off * sight.across, sight.up, sight.lean}, slope);
  }
  return sum / n;
}

/// As far as the ground's own shadows leave of `most_m` before the foot; 0: it lies in one itself.
double CornerView::lit_m(const Foot& foot, const NodeProfiles& nodes, double most_m) {
  const auto node_m = static_cast<double>(nodes.node_m);
  const float* const clearance = nodes.clearance + static_cast<std::ptrdiff_t>(foot.plane) * nodes.stride;
  const double at = foot.distance_m / node_m;
  const auto is_lit = [&](int node) {
    return static_cast<double>(clearance[node]) * node * node_m <= kShallow_m;
  };
  int node = static_cast<int>(std::min(at, nodes.n_nodes - 2.0));
  if (!is_lit(node + 1) && !is_lit(node)) return 0;
  for (; node > 0 && (at - node) * node_m < most_m; --node)
    if (!is_lit(node)) return std::max(0.0, (at - node) * node_m);
  return most_m;
}

/// Gives a piece to the range bins that its foot lies in, evenly.
void CornerView::share_out(const Foot& foot, Part part) {
  const BinGrid& bins = plan_.bins();
  const double left_m = std::hypot(foot.left_m, foot.ground_m);
  const double right_m = std::hypot(foot.right_m, foot.ground_m);
  const double from = (std::min(left_m, right_m) - bins.r_min_m) / bins.range_spacing_m;
  const double to = (std::max(left_m, right_m) - bins.r_min_m) / bins.range_spacing_m;
  if (!(to >= 0 && from < bins.n_range)) return;
  const auto first = static_cast<int>(std::max(from, 0.0));
  const auto last = static_cast<int>(std::min(to, bins.n_range - 1.0));
  for (int bin = first; bin <= last; ++bin) {
    const double low = std::max(from, bin + 0.0);
    const double high = std::min(to, bin + 1.0);
    Part piece = part;
    piece.range_bin = bin;
    piece.weight *= to > from ? (high - low) / (to - from) : 1;
    if (!(piece.weight > 0)) continue;
    piece.across *= piece.weight;
    piece.range_m = piece.weight * (bins.r_min_m + (low + high) / 2 * bins.range_spacing_m);
    piece.at_m *= piece.weight;
    if (!found_.empty() && found_.back().face == piece.face && found_.back().range_bin == bin &&
        found_.back().ground == piece.ground) {
      Part& sum = found_.back();
      sum.weight += piece.weight;
      sum.across += piece.across;
      sum.range_m += piece.range_m;
      sum.at_m += piece.at_m;
    } else {
      found_.push_back(piece);
    }
  }
}

void CornerView::put(int profile, EchoCells& cells) {
  std::ranges::stable_sort(found_, [](const Part& p, const Part& q) {
    ask(2);
    return p.face != q.face ? p.face < q.face : p.range_bin < q.range_bin;
  });
  for (std::size_t k = 0; k < found_.size();) {
    const Part& first = found_[k];
    FacePower sum{first.range_bin, first.face, first.material, 0, 0, {}, true};
    for (; k < found_.size() && found_[k].face == first.face && found_[k].range_bin == first.range_bin; ++k) {
      const Part& part = found_[k];
      const double range_m = part.range_m / part.weight;
      const glm::dvec3 at_m = part.at_m / part.weight;
      const double sigma_m2 =
          part.weight * table_->reflectivity(part.material, part.ground, part.across / part.weight);
      const double power = cells.power_of(sigma_m2, range_m, at_m);
      sum.add({0, 0, 0, power, power * range_m, power * at_m});
    }
    cells.add(profile, sum);
  }
  found_.clear();
}

}  // namespace obliq
