#include "terrain/dem/resample.h"

#include <algorithm>
#include <cmath>

#include "terrain/base/parallel.h"

namespace obliq {

namespace {

/// Heights for which a window must hold the pixels.
constexpr double kLowest_m = -500;
constexpr double kHighest_m = 9000;

/// Successive heights closer than this are settled: the next round changes the place by (x / R) of it and the
/// height by the slope of that, under 1 mm at 300 km on a 45 degree slope.
constexpr double kSettled_m = 0.02;
constexpr int kMaxRounds = 12;

double at_share(const double layers[2], double share) { return layers[0] + share * (layers[1] - layers[0]); }

/// DEM height under the plumb line through world (x, z); NaN where there is none. guess_m is where to start.
/// Of several files, one that has posts all around a place knows more of it than one whose border it is:
/// between_posts_only leaves a border's outer half pixel to the other files, and to the seams at last.
double solve_height_m(const LatticePoint& point, const DemWindow& window, double shift_columns,
                      double guess_m, bool between_posts_only) {
  double height_m = guess_m;
  for (int round = 0; round < kMaxRounds; ++round) {
    const double share = layer_share(height_m);
    const double next_m = window.height_at_m(at_share(point.column, share) + shift_columns,
                                             at_share(point.row, share), between_posts_only);
    if (!(std::abs(next_m - height_m) > kSettled_m)) return next_m;  // settled, or NaN
    height_m = next_m;
  }
  return height_m;
}

/// What the valid posts around a node say of it when they are not all four, with world y.
Seams::Share solve_share(const LatticePoint& point, const DemWindow& window, double shift_columns,
                         double guess_m) {
  DemWindow::Share found;
  found.height_m = guess_m;
  for (int round = 0; round < kMaxRounds; ++round) {
    const double before_m = found.height_m;
    const double share = layer_share(before_m);
    found = window.share_at(at_share(point.column, share) + shift_columns, at_share(point.row, share));
    if (!(found.weight > 0)) return {};
    if (std::abs(found.height_m - before_m) <= kSettled_m) break;
  }
  return {0, point.world_y_m(found.height_m), found.weight, found.owned};
}

/// True when a piece of the row between these lattice columns may touch the raster.
bool may_touch(const LatticeRow& row, int first, const DemWindow& window, double shift_columns) {
  double c0 = HUGE_VAL, c1 = -HUGE_VAL, r0 = HUGE_VAL, r1 = -HUGE_VAL;
  for (int i = first; i < first + 4; ++i) {
    const LatticePoint& p = row.points()[static_cast<std::size_t>(i)];
    for (double height_m : {kLowest_m, kHighest_m}) {
      const double share = layer_share(height_m);
      const double c = at_share(p.column, share) + shift_columns;
      const double r = at_share(p.row, share);
      if (!std::isfinite(c) || !std::isfinite(r)) return false;
      c0 = std::min(c0, c);
      c1 = std::max(c1, c);
      r0 = std::min(r0, r);
      r1 = std::max(r1, r);
    }
  }
  const double reach = window.step;  // of the outermost posts
  return c1 >= -reach && r1 >= -reach && c0 <= window.raster_columns - 1 + reach &&
         r0 <= window.raster_rows - 1 + reach;
}

void fill_row(HeightGrid& grid, int j, const PostLattice& lattice, const DemWindow& window,
              double shift_columns, double middle_m, Seams* seams) {
  const LatticeRow row(lattice, grid.node_z_m(j));
  int tested = -1;
  bool touches = false;
  for (int i = 0; i < grid.nx; ++i) {
    if (grid.node_known(i, j)) continue;
    const double x_m = grid.node_x_m(i);
    const int first = row.first_column(x_m);
    if (first != tested) {
      tested = first;
      touches = may_touch(row, first, window, shift_columns);
    }
    if (!touches) continue;
    const LatticePoint point = row.at(x_m);
    const double height_m = solve_height_m(point, window, shift_columns, middle_m, seams != nullptr);
    if (!std::isnan(height_m)) {
      grid.y_m[grid.index(i, j)] = static_cast<float>(point.world_y_m(height_m));
    } else if (seams) {
      Seams::Share share = solve_share(point, window, shift_columns, middle_m);
      share.i = i;
      if (share.weight > 0) seams->add(j, share);
    }
  }
}

/// Mean of the known heights on a coarse selection: a starting point that does not depend on the row.
double middle_height_m(const DemWindow& window) {
  double sum = 0;
  std::size_t known = 0;
  const std::size_t stride = std::max<std::size_t>(1, window.height_m.size() / 10007);
  for (std::size_t i = 0; i < window.height_m.size(); i += stride) {
    if (std::isnan(window.height_m[i])) continue;
    sum += static_cast<double>(window.height_m[i]);
    ++known;
  }
  return known == 0 ? 0 : sum / static_cast<double>(known);
}

}  // namespace

PixelRect needed_pixels(const PostLattice& lattice, const HeightGrid& grid, const Raster& raster, int step,
                        double shift_columns) {
  const GeodeticLattice& g = *lattice.geodetic;
  const double margin_m = 1.5 * GeodeticLattice::kStep_m;
  double c0 = HUGE_VAL, c1 = -HUGE_VAL, r0 = HUGE_VAL, r1 = -HUGE_VAL;
  const auto widen = [&](const LatticePoint& p) {
    for (double height_m : {kLowest_m, kHighest_m}) {
      const double share = layer_share(height_m);
      const double c = at_share(p.column, share) + shift_columns;
      const double r = at_share(p.row, share);
      if (!std::isfinite(c) || !std::isfinite(r)) continue;
      c0 = std::min(c0, c);
      c1 = std::max(c1, c);
      r0 = std::min(r0, r);
      r1 = std::max(r1, r);
    }
  };
  // The grid's own rectangle on a mesh of lattice steps: its border bends between lattice nodes by less than
  // the margin of pixels added below.
  const int nx = 1 + static_cast<int>(std::ceil((grid.x1_m() - grid.x0_m) / margin_m));
  const int nz = 1 + static_cast<int>(std::ceil((grid.z1_m() - grid.z0_m) / margin_m));
  for (int j = 0; j <= nz; ++j) {
    const LatticeRow row(lattice, grid.z0_m + (grid.z1_m() - grid.z0_m) * j / nz);
    for (int i = 0; i <= nx; ++i) widen(row.at(grid.x0_m + (grid.x1_m() - grid.x0_m) * i / nx));
  }
  if (!(c0 <= c1) || g.size() == 0) return {};
  const double pad = 3.0 * step + 2;
  const auto clip = [](double v, int n) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(n)));
  };
  return {clip(std::floor(c0 - pad), raster.columns()), clip(std::floor(r0 - pad), raster.rows()),
          clip(std::ceil(c1 + pad) + 1, raster.columns()), clip(std::ceil(r1 + pad) + 1, raster.rows())};
}

void fill_from_window(HeightGrid& grid, const PostLattice& lattice, const DemWindow& window,
                      double shift_columns, Seams* seams) {
  const double middle_m = middle_height_m(window);
  for_each_row(grid.nz, [&](int j) { fill_row(grid, j, lattice, window, shift_columns, middle_m, seams); });
}

void Seams::close(HeightGrid& grid) {
  for (int j = 0; j < grid.nz; ++j) {
    std::vector<Share>& row = rows_[static_cast<std::size_t>(j)];
    // Stable: the shares of a node stay in the order of the files, so that sums have the same bits each time.
    std::stable_sort(row.begin(), row.end(), [](const Share& a, const Share& b) { return a.i < b.i; });
    for (std::size_t k = 0; k < row.size();) {
      const int i = row[k].i;
      double sum = 0;
      double weight = 0;
      bool owned = false;
      for (; k < row.size() && row[k].i == i; ++k) {
        sum += row[k].weight * row[k].y_m;
        weight += row[k].weight;
        owned = owned || row[k].owned;
      }
      if (owned && !grid.node_known(i, j)) grid.y_m[grid.index(i, j)] = static_cast<float>(sum / weight);
    }
  }
}

}  // namespace obliq
