#include "server/radar/sweep/corner_view.h"

#include <algorithm>
#include <cmath>

#include "server/radar/sweep/sort_keys.h"
#include "terrain/base/asking.h"
#include "terrain/ground_slope.h"

namespace obliq {
namespace {

constexpr int kAFoot = 8;  // in units of ask()

/// Ground that lies so far below the horizon before it counts as lit: floats keep a slope to 1e-7.
constexpr double kShallow_m = 0.01;

/// A foot is divided where the lobe's tangent turns by more than this share of the rms slope.
constexpr double kLobeStep = 0.25;
constexpr double kMostSteps = 64;

}  // namespace

bool CornerView::begin(const Foot& foot, const NodeProfiles& nodes) {
  const double down = -foot.ground_m / foot.distance_m;
  const double across = -(foot.normal_x * foot.bearing.sin + foot.normal_z * foot.bearing.cos);
  const double along = foot.normal_x * foot.bearing.cos - foot.normal_z * foot.bearing.sin;
  if (!(down > 0 && foot.roof_m > foot.ground_m && across > 0)) return false;
  ask(kAFoot);
  foot_ = foot;
  down_ = down;
  level_ = 1 / std::sqrt(1 + down * down);
  across_ = across * level_;
  if (!lay_strip(across, along)) return false;
  end_m_ = terrain_lit_m(nodes, pieces_[n_pieces_ - 1].to_m);
  return end_m_ > 0;
}

void CornerView::spread(double left_m, double right_m) {
  const BinGrid& bins = plan_.bins();
  const auto bin_at = [&](double d) {
    return (std::sqrt(d * d + foot_.ground_m * foot_.ground_m) - bins.r_min_m) / bins.range_spacing_m;
  };
  left_bin_ = bin_at(left_m);
  right_bin_ = bin_at(right_m);
}

/// The ground that takes part lies before the foot in the direction that the wall mirrors: pieces of a cell
/// or of a share of the strip that level ground would give. False: all dark.
bool CornerView::lay_strip(double across, double along) {
  const World& world = plan_.scene().world();
  const HeightGrid& grid = world.grid;
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const double foot_x = antenna.x + foot_.distance_m * foot_.bearing.sin;
  const double foot_z = antenna.z + foot_.distance_m * foot_.bearing.cos;
  const double mirrored_x = 2 * across * foot_.normal_x + foot_.bearing.sin;
  const double mirrored_z = 2 * across * foot_.normal_z + foot_.bearing.cos;
  const double level_m = (foot_.roof_m - foot_.ground_m) / down_;
  const double piece_m = std::max(level_m / kMostPieces, std::min(level_m, grid.cell_m));
  const double per_m = 1 / foot_.distance_m;
  bool any = false;
  n_pieces_ = 0;
  for (double from_m = 0; n_pieces_ < 2 * kMostPieces; from_m += piece_m) {
    const double x = foot_x + (from_m + piece_m / 2) * mirrored_x;
    const double z = foot_z + (from_m + piece_m / 2) * mirrored_z;
    const GroundSlope under = ground_slope_at(grid, x, z);
    if (!under.known) break;
    const FootSlope slope{under.per_x * foot_.normal_x + under.per_z * foot_.normal_z,
                          under.per_x * foot_.normal_z - under.per_z * foot_.normal_x};
    // Towards the antenna the ground rises by `rise` a metre, in the mirrored direction by `gain`.
    const double rise = slope.across * across + slope.along * along;
    const double gain = slope.across * across - slope.along * along;
    if (n_pieces_ == 0) rise_ = rise;
    const double h = under.y_m - antenna.y;
    // The ray to the antenna's image meets the wall below the roof.
    const double room_m = foot_.roof_m * (1 + from_m * per_m) - (h - gain * piece_m / 2);
    const double closing = gain - foot_.roof_m * per_m;
    const double length_m = closing > 0 ? std::min(piece_m, room_m / closing) : piece_m;
    if (!(length_m > 0 && down_ + rise > 0)) break;
    const double before = (from_m + length_m / 2) * per_m;
    const double down_there = -(h + gain * (length_m - piece_m) / 2) * per_m;
    const std::uint8_t ground = world.material_of_cell(under.i, under.j);
    const double lobe =
        mean_lobe(ground, CornerSight::over_ground(across, along, level_, before, down_there), slope);
    double weight = 0;
    if (lobe > 0) {
      any = true;
      // Rays spread on their way from the wall over the strip.
      weight = lobe * foot_.width_rad * foot_.distance_m * (1 + before) *
               std::sqrt(1 + slope.across * slope.across + slope.along * slope.along);
    }
    pieces_[n_pieces_++] = {from_m, from_m + length_m, weight, ground};
    if (length_m < piece_m) break;
  }
  return any;
}

/// The lobe across the foot.
double CornerView::mean_lobe(std::uint8_t ground, const CornerSight& sight, const FootSlope& slope) const {
  const double turn = foot_.width_rad * sight.across;
  if (turn <= kLobeStep * table_->narrowest_slope() * sight.up) return table_->lobe(ground, sight, slope);
  const double n = std::min(std::ceil(turn / (kLobeStep * table_->narrowest_slope() * sight.up)), kMostSteps);
  CornerSight at = sight;
  double sum = 0;
  for (double k = 0.5; k < n; ++k) {
    at.along = sight.along + (k / n - 0.5) * turn;
    sum += table_->lobe(ground, at, slope);
  }
  return sum / n;
}

/// As far as the ground's own shadows leave of `most_m` before the foot; 0: it lies in one itself.
double CornerView::terrain_lit_m(const NodeProfiles& nodes, double most_m) const {
  const auto node_m = static_cast<double>(nodes.node_m);
  const float* const clearance = nodes.clearance + static_cast<std::ptrdiff_t>(foot_.plane) * nodes.stride;
  const double at = foot_.distance_m / node_m;
  const auto is_lit = [&](int node) {
    return static_cast<double>(clearance[node]) * node * node_m <= kShallow_m;
  };
  int node = static_cast<int>(std::min(at, nodes.n_nodes - 2.0));
  if (!is_lit(node + 1) && !is_lit(node)) return 0;
  for (; node > 0 && (at - node) * node_m < most_m; --node)
    if (!is_lit(node)) return std::max(0.0, (at - node) * node_m);
  return most_m;
}

void CornerView::light(double from, double to, double shade) {
  if (shade >= -down_) return;
  double lit_m = end_m_;
  // Where the shadow ends, on ground that goes on as it begins.
  const double steeper = -shade - rise_;
  const double to_shade = foot_.distance_m * (-shade - down_);
  if (to_shade < steeper * lit_m) lit_m = to_shade / steeper;
  for (int k = 0; k < n_pieces_;) {
    const std::uint8_t ground = pieces_[k].ground;
    double weight = 0;
    for (; k < n_pieces_ && pieces_[k].ground == ground; ++k)
      weight += pieces_[k].weight * std::max(0.0, std::min(pieces_[k].to_m, lit_m) - pieces_[k].from_m);
    if (weight > 0) share_out(from, to, ground, weight * (to - from));
  }
}

/// Gives a part of the foot to the range bins that it lies in, evenly.
void CornerView::share_out(double from, double to, std::uint8_t ground, double weight) {
  const BinGrid& bins = plan_.bins();
  const double one = left_bin_ + from * (right_bin_ - left_bin_);
  const double other = left_bin_ + to * (right_bin_ - left_bin_);
  const double low = std::min(one, other), high = std::max(one, other);
  if (!(high >= 0 && low < bins.n_range)) return;
  const auto first = static_cast<int>(std::max(low, 0.0));
  const auto last = static_cast<int>(std::min(high, bins.n_range - 1.0));
  for (int bin = first; bin <= last; ++bin) {
    const double begin = std::max(low, bin + 0.0);
    const double end = std::min(high, bin + 1.0);
    const double share = high > low ? weight * (end - begin) / (high - low) : weight;
    if (!(share > 0)) continue;
    if (found_.empty() || found_.back().face != foot_.face || found_.back().range_bin != bin ||
        found_.back().ground != ground)
      found_.push_back({foot_.building, foot_.face, bin, foot_.material, ground, 0, 0, 0, {}});
    Part& sum = found_.back();
    const double across_m = ((from + to) / 2 - 0.5) * foot_.width_rad * foot_.distance_m;
    const glm::dvec3& antenna = plan_.sector().antenna_m;
    const SinCos& bearing = foot_.bearing;
    sum.weight += share;
    sum.across += share * across_;
    sum.range_m += share * (bins.r_min_m + (begin + end) / 2 * bins.range_spacing_m);
    sum.at_m += share * glm::dvec3(antenna.x + foot_.distance_m * bearing.sin + across_m * bearing.cos,
                                   antenna.y + foot_.ground_m,
                                   antenna.z + foot_.distance_m * bearing.cos - across_m * bearing.sin);
  }
}

void CornerView::put(int profile, EchoCells& cells) {
  if (found_.empty()) return;
  order_.clear();
  for (std::uint32_t k = 0; k < found_.size(); ++k) order_.emplace_back(found_[k].echo(), k);
  sort_keys(order_);
  for (std::size_t k = 0; k < order_.size();) {
    const auto [echo, place] = order_[k];
    const Part& first = found_[place];
    FacePower sum{first.range_bin, first.building, first.face, first.material, 0, 0, {}, true};
    for (; k < order_.size() && order_[k].first == echo; ++k) {
      const Part& part = found_[order_[k].second];
      const double range_m = part.range_m / part.weight;
      const glm::dvec3 at_m = part.at_m / part.weight;
      const double sigma_m2 =
          part.weight * table_->reflectivity(part.material, part.ground, part.across / part.weight);
      const double power = cells.power_of(sigma_m2, range_m, at_m);
      sum.add({0, 0, 0, 0, power, power * range_m, power * at_m});
    }
    cells.add(profile, sum);
  }
  found_.clear();
}

}  // namespace obliq
