#include "server/radar/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/radar/ground_walk.h"
#include "server/radar/roof_steps.h"
#include "server/radar/sweep_samples.h"

namespace obliq {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Marks the range bins that a connected stretch of profile covers. Slant range is continuous along it, so
/// its least and greatest range are enough, and they need one square root each for the whole stretch.
class RangeRun {
 public:
  void add(double d, double h) {
    const double r2 = d * d + h * h;
    least2_ = std::min(least2_, r2);
    greatest2_ = std::max(greatest2_, r2);
  }
  /// A straight piece; the foot of the perpendicular from the antenna may lie on it, nearer than both ends.
  void add(double d0, double h0, double d1, double h1) {
    add(d0, h0);
    add(d1, h1);
    const double dd = d1 - d0;
    const double dh = h1 - h0;
    const double along = -(d0 * dd + h0 * dh);
    if (along <= 0) return;
    const double length2 = dd * dd + dh * dh;
    if (along >= length2) return;
    const double cross = d0 * dh - h0 * dd;
    least2_ = std::min(least2_, cross * cross / length2);
  }
  void close(const BinGrid& bins, std::vector<std::uint8_t>& plane) {
    if (greatest2_ >= 0) {
      const double low = std::sqrt(least2_);
      const double high = std::sqrt(greatest2_);
      if (high >= bins.r_min_m && low < bins.r_max_m) {
        const int last = high >= bins.r_max_m ? bins.n_range - 1 : bins.range_bin(high);
        for (int bin = low < bins.r_min_m ? 0 : bins.range_bin(low); bin <= last; ++bin)
          plane[static_cast<std::size_t>(bin)] = 1;
      }
    }
    least2_ = kInfinity;
    greatest2_ = -1;
  }

 private:
  double least2_ = kInfinity;
  double greatest2_ = -1;  // negative: empty
};

/// Carries the running horizon outwards. Heights are relative to the antenna. The horizon is kept as the
/// point (horizon_d, horizon_h) that set it: slopes are compared by cross products, without a division.
class Marcher {
 public:
  Marcher(const BinGrid& bins, double antenna_y_m, ProfileResult& result)
      : bins_(bins), antenna_y_m_(antenna_y_m), result_(result) {}

  /// Surface from (d0, y0) to (d1, y1); a rise from where the last piece ended is a wall.
  void piece(double d0, double y0, double d1, double y1) {
    const double h0 = y0 - antenna_y_m_;
    const double h1 = y1 - antenna_y_m_;
    // Rounding leaves steps of 1e-9 m where pieces meet.
    if (joined_ && h0 > last_h_m_ + 1e-6) wall(d0, last_h_m_, h0);
    present_.add(d0, h0, d1, h1);
    if (hidden(d1, h1)) {
      end_visible();
      if (!hidden(d0, h0)) set_horizon(d0, h0);
    } else if (h1 * d0 > h0 * d1) {  // rising in elevation: its upper side faces the antenna
      if (hidden(d0, h0)) {
        // Where the piece comes out of the shadow: h(d) = horizon d.
        end_visible();
        const double rise = (h1 - h0) / (d1 - d0);
        const double from = std::clamp((h0 - rise * d0) / (horizon_h_ / horizon_d_ - rise), d0, d1);
        visible_.add(from, h0 + rise * (from - d0), d1, h1);
      } else {
        visible_.add(d0, h0, d1, h1);
      }
      set_horizon(d1, h1);
    } else {  // falls away: seen at its near edge only
      end_visible();
      set_horizon(d0, h0);
    }
    joined_ = true;
    last_h_m_ = h1;
  }

  /// No surface follows; the next piece starts without a wall.
  void gap() {
    end_visible();
    present_.close(bins_, result_.present);
    joined_ = false;
  }

 private:
  /// Strictly below the horizon. At the start the horizon is straight down, (0, -1): nothing is below it.
  bool hidden(double d, double h) const { return h * horizon_d_ < horizon_h_ * d; }

  void set_horizon(double d, double h) {
    if (!(d > 0)) return;
    horizon_d_ = d;
    horizon_h_ = h;
  }

  void end_visible() { visible_.close(bins_, result_.visible); }

  void wall(double d, double low, double high) {
    present_.add(d, low);
    if (hidden(d, high)) return;
    end_visible();
    visible_.add(d, horizon_d_ > 0 ? std::max(low, horizon_h_ / horizon_d_ * d) : low, d, high);
    set_horizon(d, high);
  }

  const BinGrid& bins_;
  double antenna_y_m_;
  ProfileResult& result_;
  RangeRun visible_;
  RangeRun present_;
  double horizon_d_ = 0;
  double horizon_h_ = -1;
  bool joined_ = false;
  double last_h_m_ = 0;
};

/// Hands the ground of one plane to the marcher, cut at footprint edges, with roofs on top.
class Surface {
 public:
  Surface(std::vector<RoofStep> steps, Marcher& marcher) : steps_(std::move(steps)), marcher_(marcher) {}

  void ground(const GroundPiece& piece) {
    if (step_ < steps_.size()) {
      with_roofs(piece.d0_m, piece.d1_m, piece.start_m, piece.rise);
    } else {
      marcher_.piece(piece.d0_m, piece.start_m + piece.rise * piece.d0_m, piece.d1_m,
                     piece.start_m + piece.rise * piece.d1_m);
    }
  }
  void gap(double d0, double d1) {
    marcher_.gap();
    gaps_.push_back({d0, d1});
  }
  static bool enough() { return false; }

  /// Stretches without known ground.
  const std::vector<std::pair<double, double>>& gaps() const { return gaps_; }

 private:
  /// Ground y = start + rise d on [d0, d1], replaced by roofs that stand above it.
  void with_roofs(double d0, double d1, double start, double rise) {
    double d = d0;
    while (d < d1) {
      while (step_ < steps_.size() && steps_[step_].far_m <= d) ++step_;
      double end = d1;
      bool roofed = false;
      if (step_ < steps_.size()) {
        roofed = steps_[step_].near_m <= d;
        end = std::min(end, roofed ? steps_[step_].far_m : steps_[step_].near_m);
      }
      const double y0 = start + rise * d;
      const double y1 = start + rise * end;
      const double roof = roofed ? steps_[step_].roof_y_m : -kInfinity;
      marcher_.piece(d, std::max(y0, roof), end, std::max(y1, roof));
      d = end;
    }
  }

  std::vector<RoofStep> steps_;
  std::size_t step_ = 0;
  Marcher& marcher_;
  std::vector<std::pair<double, double>> gaps_;
};

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
  const BinGrid& bins = plan.bins();
  const Sector& sector = plan.sector();
  const World& world = plan.scene().world();
  const HeightGrid& grid = world.grid;
  const glm::dvec3& antenna = sector.antenna_m;
  result.visible.assign(static_cast<std::size_t>(bins.n_range), 0);
  result.present.assign(static_cast<std::size_t>(bins.n_range), 0);

  const double bearing = sector.bearing_rad + bins.azimuth_edge_rad(position);
  const double sin_b = std::sin(bearing);
  const double cos_b = std::cos(bearing);
  // A building that reaches across a bin's edge is in the lists of both bins.
  const int azimuth_bin = std::min(static_cast<int>(position), bins.n_azimuth - 1);
  spans.clear();
  for (const std::uint32_t b : plan.buildings_in(azimuth_bin))
    footprint_spans(world.buildings, b, antenna.x, antenna.z, sin_b, cos_b, spans);

  // The sector's ground between r_min and r_max at the median height, for coverage.
  const double clearance = plan.extent().any ? antenna.y - plan.extent().median_height_m -
                                                   world.frame.datum_y_m(antenna.x, antenna.z)
                                             : 0.0;
  const double near_m = std::sqrt(std::max(0.0, bins.r_min_m * bins.r_min_m - clearance * clearance));
  const double far_m = std::sqrt(std::max(0.0, bins.r_max_m * bins.r_max_m - clearance * clearance));
  const auto ring_area = [&](double d0, double d1) {
    const double a = std::clamp(d0, near_m, far_m);
    const double b = std::clamp(d1, near_m, far_m);
    return 0.5 * bins.azimuth_width_rad * (b - a) * (b + a);
  };
  result.sector_area_m2 = ring_area(near_m, far_m);

  Marcher marcher(bins, antenna.y, result);
  GroundWalk walk(grid, antenna, sin_b, cos_b, 0, bins.r_max_m);
  if (walk.done()) {
    result.covered_area_m2 = 0;
    return;
  }
  double missing_m2 = ring_area(0, walk.at_m()) + ring_area(walk.end_m(), bins.r_max_m);
  Surface surface(disjoint_roofs(world.buildings, spans), marcher);
  walk.advance(walk.end_m(), surface);
  for (const auto& [d0, d1] : surface.gaps()) missing_m2 += ring_area(d0, d1);
  marcher.gap();
  result.covered_area_m2 = std::max(0.0, result.sector_area_m2 - missing_m2);
}

}  // namespace obliq
