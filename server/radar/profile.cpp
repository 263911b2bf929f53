#include "server/radar/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obliq {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Footprint stretches as disjoint steps, the highest roof where they overlap; sorted by distance.
std::vector<FootprintSpan> disjoint(std::vector<FootprintSpan>& spans) {
  std::vector<FootprintSpan> steps;
  if (spans.empty()) return steps;
  std::vector<double> edges;
  for (const FootprintSpan& span : spans) {
    edges.push_back(span.near_m);
    edges.push_back(span.far_m);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::sort(spans.begin(), spans.end(), [](const FootprintSpan& a, const FootprintSpan& b) {
    return a.near_m != b.near_m ? a.near_m < b.near_m : a.roof_y_m < b.roof_y_m;
  });
  std::size_t next = 0;
  std::vector<FootprintSpan> active;
  for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
    while (next < spans.size() && spans[next].near_m <= edges[e]) active.push_back(spans[next++]);
    std::erase_if(active, [&](const FootprintSpan& span) { return span.far_m <= edges[e]; });
    double roof = -kInfinity;
    for (const FootprintSpan& span : active) roof = std::max(roof, span.roof_y_m);
    if (roof > -kInfinity) steps.push_back({edges[e], edges[e + 1], roof});
  }
  return steps;
}

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

/// Ground distances at which the half-line is over the grid: [from, to], empty when from >= to.
struct Clip {
  double from = 0;
  double to;

  Clip(const HeightGrid& grid, double x, double z, double sin_b, double cos_b, double reach) : to(reach) {
    cut(x, sin_b, grid.x0_m, grid.x1_m());
    cut(z, cos_b, grid.z0_m, grid.z1_m());
  }
  void cut(double start, double rate, double low, double high) {
    if (rate == 0) {
      if (start < low || start > high) to = -1;
      return;
    }
    const double a = (low - start) / rate;
    const double b = (high - start) / rate;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
};

/// Feeds the pieces of one grid cell, cut at its diagonal and at footprint edges, to the marcher.
class CellCutter {
 public:
  CellCutter(const HeightGrid& grid, const glm::dvec3& antenna, double sin_b, double cos_b,
             std::vector<FootprintSpan> steps, Marcher& marcher)
      : grid_(grid),
        start_u_((antenna.x - grid.x0_m) / grid.cell_m),
        start_v_((antenna.z - grid.z0_m) / grid.cell_m),
        rate_u_(sin_b / grid.cell_m),
        rate_v_(cos_b / grid.cell_m),
        steps_(std::move(steps)),
        marcher_(marcher) {}

  /// Cell (i, j), crossed from d0 to d1. With s, t the position in the cell, the triangles meet at s + t = 1.
  void cell(int i, int j, double d0, double d1) {
    const double s = start_u_ - i;
    const double t = start_v_ - j;
    const double rate = rate_u_ + rate_v_;
    const double sum0 = s + t + d0 * rate;
    const double sum1 = s + t + d1 * rate;
    if ((sum0 < 1) != (sum1 < 1)) {
      const double cut = std::clamp((1 - s - t) / rate, d0, d1);
      triangle(i, j, sum0 > sum1, d0, cut);
      triangle(i, j, sum0 < sum1, cut, d1);
    } else {
      triangle(i, j, sum0 + sum1 > 2, d0, d1);
    }
  }

 private:
  void triangle(int i, int j, bool upper, double d0, double d1) {
    if (!(d1 > d0)) return;
    const double y10 = grid_.node_y_m(i + 1, j);
    const double y01 = grid_.node_y_m(i, j + 1);
    const int corner = upper ? 1 : 0;
    const double base = grid_.node_y_m(i + corner, j + corner);
    const double per_u = upper ? base - y01 : y10 - base;
    const double per_v = upper ? base - y10 : y01 - base;
    const double start = base + per_u * (start_u_ - (i + corner)) + per_v * (start_v_ - (j + corner));
    const double rise = per_u * rate_u_ + per_v * rate_v_;
    if (step_ < steps_.size()) {
      with_roofs(d0, d1, start, rise);
    } else {
      marcher_.piece(d0, start + rise * d0, d1, start + rise * d1);
    }
  }

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

  const HeightGrid& grid_;
  double start_u_, start_v_;  // the antenna, in cells from node (0, 0)
  double rate_u_, rate_v_;    // cells a metre of ground distance
  std::vector<FootprintSpan> steps_;
  std::size_t step_ = 0;
  Marcher& marcher_;
};

}  // namespace

int profile_strands(const FramePlan& plan) {
  const double arc_m = plan.bins().r_max_m * plan.bins().azimuth_width_rad;
  const double pairs = std::ceil(arc_m / plan.scene().world().grid.cell_m / 2);
  return 2 * static_cast<int>(std::clamp(pairs, 1.0, 4.0));
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
    footprint_spans(world.buildings, world.buildings.list[b], antenna.x, antenna.z, sin_b, cos_b, spans);

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
  double missing_m2 = 0;

  Marcher marcher(bins, antenna.y, result);
  CellCutter cutter(grid, antenna, sin_b, cos_b, disjoint(spans), marcher);
  const Clip clip(grid, antenna.x, antenna.z, sin_b, cos_b, bins.r_max_m);
  if (!(clip.from < clip.to)) {
    result.covered_area_m2 = 0;
    return;
  }
  missing_m2 += ring_area(0, clip.from) + ring_area(clip.to, bins.r_max_m);

  // Cell by cell: the next grid line in x or z, whichever is nearer.
  const auto cell_of = [&](double at, double origin, int n) {
    return std::clamp(static_cast<int>(std::floor((at - origin) / grid.cell_m)), 0, n - 2);
  };
  int i = cell_of(antenna.x + clip.from * sin_b, grid.x0_m, grid.nx);
  int j = cell_of(antenna.z + clip.from * cos_b, grid.z0_m, grid.nz);
  const int step_i = sin_b > 0 ? 1 : -1;
  const int step_j = cos_b > 0 ? 1 : -1;
  const double per_x = sin_b != 0 ? 1 / sin_b : kInfinity;
  const double per_z = cos_b != 0 ? 1 / cos_b : kInfinity;
  double d = clip.from;
  while (d < clip.to && i >= 0 && j >= 0 && i < grid.nx - 1 && j < grid.nz - 1) {
    const double to_x = sin_b != 0 ? (grid.node_x_m(step_i > 0 ? i + 1 : i) - antenna.x) * per_x : kInfinity;
    const double to_z = cos_b != 0 ? (grid.node_z_m(step_j > 0 ? j + 1 : j) - antenna.z) * per_z : kInfinity;
    const double end = std::max(d, std::min({to_x, to_z, clip.to}));
    if (grid.cell_known(i, j)) {
      cutter.cell(i, j, d, end);
    } else {
      marcher.gap();
      missing_m2 += ring_area(d, end);
    }
    if (to_x < to_z) {
      i += step_i;
    } else {
      j += step_j;
    }
    d = end;
  }
  marcher.gap();
  result.covered_area_m2 = std::max(0.0, result.sector_area_m2 - missing_m2);
}

}  // namespace obliq
