#include "server/radar/geometry/sector_extent.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "server/radar/geometry/circle_axes.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

enum class Overlap { none, partial, full };

/// At a tile or a corner, in units of ask().
constexpr int kLook = 4;

/// Collects extremes over tiles and posts of one sector.
class SectorScan {
 public:
  SectorScan(const Scene& scene, const Sector& sector)
      : world_(scene.world()),
        tiles_(scene.tiles()),
        fine_tiles_(scene.fine_tiles()),
        circles_(scene.circles()),
        sector_(sector),
        margin_m_(1.5 * world_.grid.cell_m),
        sin_half_(std::sin(sector.width_rad / 2)),
        cos_half_(std::cos(sector.width_rad / 2)) {}

  SectorExtent run() {
    visit_tiles(tiles_, {0, tiles_.tiles_x(), 0, tiles_.tiles_z()});
    visit_buildings();
    // Roofs alone in the swath, their ground too far or too near: the walls' feet bound them.
    if (bottom_ > top_ && top_ >= base_)
      bottom_ = std::clamp(sector_.antenna_m.y - sector_.r_max_m, base_, top_);
    SectorExtent extent;
    extent.any = bottom_ <= top_;
    if (!extent.any) return extent;
    extent.bottom_y_m = bottom_;
    extent.top_y_m = top_;
    extent.highest_elevation_rad = std::atan(tangent_);
    const auto middle = heights_.begin() + static_cast<std::ptrdiff_t>(heights_.size() / 2);
    std::nth_element(heights_.begin(), middle, heights_.end());
    extent.median_height_m = heights_.empty() ? bottom_ : *middle;
    return extent;
  }

 private:
  bool holds(double x_m, double y_m, double z_m) const {
    const double right = sector_.right_m(x_m, z_m);
    const double ahead = sector_.ahead_m(x_m, z_m);
    const double up = y_m - sector_.antenna_m.y;
    const double range = std::sqrt(right * right + ahead * ahead + up * up);
    if (range > sector_.r_max_m + margin_m_ || range < sector_.r_min_m - margin_m_) return false;
    return in_azimuth(right, ahead);
  }

  bool in_azimuth(double right, double ahead) const {
    // Distances beyond the right and the left edge of the sector.
    const double past_right = right * cos_half_ - ahead * sin_half_;
    const double past_left = -right * cos_half_ - ahead * sin_half_;
    if (sector_.width_rad > kPi) return past_right <= margin_m_ || past_left <= margin_m_;
    return past_right <= margin_m_ && past_left <= margin_m_ && ahead >= -margin_m_;
  }

  Overlap overlap(double x_m, double z_m, double radius_m, double lowest_m, double highest_m,
                  double spare_m = 0) const {
    const double ground = std::hypot(x_m - sector_.antenna_m.x, z_m - sector_.antenna_m.z);
    const double near = std::max(0.0, ground - radius_m);
    const double below = sector_.antenna_m.y - lowest_m;
    const double above = sector_.antenna_m.y - highest_m;
    const double up_max = std::max(std::abs(below), std::abs(above));
    const double up_min = below >= 0 && above <= 0 ? 0 : std::min(std::abs(below), std::abs(above));
    const double range_min = std::hypot(near, up_min);
    const double range_max = std::hypot(ground + radius_m, up_max);
    if (range_min > sector_.r_max_m + spare_m || range_max < sector_.r_min_m - spare_m) return Overlap::none;
    const bool range_inside = range_min >= sector_.r_min_m && range_max <= sector_.r_max_m;
    if (ground <= radius_m) return Overlap::partial;
    const double half_angle = std::asin(std::min(1.0, radius_m / ground));
    const double offset = std::abs(std::atan2(sector_.right_m(x_m, z_m), sector_.ahead_m(x_m, z_m)));
    if (offset - half_angle > sector_.width_rad / 2) return Overlap::none;
    return range_inside && offset + half_angle <= sector_.width_rad / 2 ? Overlap::full : Overlap::partial;
  }

  /// The part of a vertical line that lies in sector and swath; nothing when none does. A line stands for a
  /// steep edge of the mesh or a wall, both ends of which may be out of range while its middle is not.
  struct Reach {
    bool any = false;
    double low_y_m = 0, high_y_m = 0;
  };
  Reach reach(double x_m, double z_m, double low_y_m, double high_y_m) const {
    const double right = sector_.right_m(x_m, z_m);
    const double ahead = sector_.ahead_m(x_m, z_m);
    const double ground2 = right * right + ahead * ahead;
    const double far_m = sector_.r_max_m + margin_m_;
    if (ground2 > far_m * far_m || !in_azimuth(right, ahead)) return {};
    const double near_m = std::max(0.0, sector_.r_min_m - margin_m_);
    // Heights relative to the antenna between -farthest and -nearest or between nearest and farthest.
    const double farthest = std::sqrt(far_m * far_m - ground2);
    const double nearest = std::sqrt(std::max(0.0, near_m * near_m - ground2));
    double low = std::max(low_y_m - sector_.antenna_m.y, -farthest);
    double high = std::min(high_y_m - sector_.antenna_m.y, farthest);
    if (low > -nearest) low = std::max(low, nearest);
    if (high < nearest) high = std::min(high, -nearest);
    if (!(low <= high)) return {};
    return {true, low + sector_.antenna_m.y, high + sector_.antenna_m.y};
  }

  void raise(double x_m, double y_m, double z_m) {
    const double dx = x_m - sector_.antenna_m.x;
    const double dz = z_m - sector_.antenna_m.z;
    const double up = y_m - sector_.antenna_m.y;
    // Few points rise above all before them: the others need no exact distance.
    const double limit = tangent_ * std::sqrt(dx * dx + dz * dz);
    if (up < limit - 1e-12 * std::abs(limit)) return;
    const double ground = std::hypot(dx, dz);
    tangent_ = std::max(tangent_, ground > 0 ? up / ground : up > 0 ? kInfinity : -kInfinity);
  }

  /// A point of a building in sector and swath.
  void raise_building(const Building& building, double x_m, double y_m, double z_m) {
    top_ = std::max(top_, y_m);
    base_ = std::min(base_, static_cast<double>(building.base_y_m));
    raise(x_m, y_m, z_m);
  }

  struct Tiles {
    int i0, i1, j0, j1;
  };

  /// Those far ahead first: seen from above they stand highest, and most of the others need no look.
  void visit_tiles(const TileBounds& tiles, const Tiles& all) {
    const bool north = sector_.ahead_m(sector_.antenna_m.x, sector_.antenna_m.z + 1) > 0;
    const bool east = sector_.ahead_m(sector_.antenna_m.x + 1, sector_.antenna_m.z) > 0;
    for (int j = all.j0; j < all.j1; ++j) {
      ask(kLook * (all.i1 - all.i0));
      for (int i = all.i0; i < all.i1; ++i)
        visit_tile(tiles, east ? all.i1 - 1 - (i - all.i0) : i, north ? all.j1 - 1 - (j - all.j0) : j);
    }
  }

  /// Whether a circle lies beyond the swath or beside the sector by distances alone; false says nothing.
  bool is_far_off(double x_m, double z_m, double radius_m, double spare_m) const {
    const double right = sector_.right_m(x_m, z_m), ahead = sector_.ahead_m(x_m, z_m);
    const double reach = sector_.r_max_m + spare_m + radius_m;
    if (right * right + ahead * ahead > reach * reach) return true;
    return sector_.width_rad <= kPi && (right * cos_half_ - ahead * sin_half_ > radius_m ||
                                        -right * cos_half_ - ahead * sin_half_ > radius_m);
  }

  /// Whether no post of a tile, nor any edge that begins there, can be lower, higher or stand at a greater
  /// elevation than what has been seen.
  bool changes_nothing(const TileBounds::Tile& heights, double x_m, double z_m, double radius_m) const {
    const double ground = std::hypot(x_m - sector_.antenna_m.x, z_m - sector_.antenna_m.z);
    const double up = static_cast<double>(heights.highest_m) - sector_.antenna_m.y;
    return static_cast<double>(heights.lowest_m) >= bottom_ &&
           static_cast<double>(heights.highest_m) <= top_ && ground > radius_m &&
           up / (up > 0 ? ground - radius_m : ground + radius_m) <= tangent_;
  }

  /// An edge from a tile's border ends in the next one.
  static TileBounds::Tile with_neighbours(const TileBounds& tiles, int ti, int tj) {
    TileBounds::Tile all = tiles.tile(ti, tj);
    for (int j = std::max(0, tj - 1); j <= std::min(tiles.tiles_z() - 1, tj + 1); ++j)
      for (int i = std::max(0, ti - 1); i <= std::min(tiles.tiles_x() - 1, ti + 1); ++i) {
        all.lowest_m = std::min(all.lowest_m, tiles.tile(i, j).lowest_m);
        all.highest_m = std::max(all.highest_m, tiles.tile(i, j).highest_m);
      }
    return all;
  }

  void visit_tile(const TileBounds& tiles, int ti, int tj) {
    const TileBounds::Tile& tile = tiles.tile(ti, tj);
    if (!(tile.lowest_m <= tile.highest_m)) return;
    const HeightGrid& grid = world_.grid;
    const int i0 = ti * tiles.cells();
    const int j0 = tj * tiles.cells();
    const int i1 = std::min(grid.nx - 1, i0 + tiles.cells());
    const int j1 = std::min(grid.nz - 1, j0 + tiles.cells());
    const double x = (grid.node_x_m(i0) + grid.node_x_m(i1)) / 2;
    const double z = (grid.node_z_m(j0) + grid.node_z_m(j1)) / 2;
    const double radius = std::hypot(grid.node_x_m(i1) - x, grid.node_z_m(j1) - z) + margin_m_;
    const auto lowest = static_cast<double>(tile.lowest_m);
    const auto highest = static_cast<double>(tile.highest_m);
    // Whether some of a tile's posts count is asked of the large ones alone; of what they hold, with a margin
    // to spare.
    const bool large = &tiles == &tiles_;
    const double spare = large ? 0 : margin_m_;
    if (is_far_off(x, z, radius + spare, spare)) return;
    const Overlap kind = overlap(x, z, radius + spare, lowest, highest, spare);
    if (kind == Overlap::none) return;
    if (large) take_middle((i0 + i1) / 2, (j0 + j1) / 2);
    if (kind == Overlap::full) {
      bottom_ = std::min(bottom_, lowest);
      top_ = std::max(top_, highest);
      if (changes_nothing(tile, x, z, radius)) return;
    } else if (changes_nothing(with_neighbours(tiles, ti, tj), x, z, radius)) {
      return;
    }
    if (large) {
      constexpr int kFine = TileBounds::kCells / TileBounds::kFineCells;
      visit_tiles(fine_tiles_, {ti * kFine, std::min(fine_tiles_.tiles_x(), (ti + 1) * kFine), tj * kFine,
                                std::min(fine_tiles_.tiles_z(), (tj + 1) * kFine)});
      return;
    }
    // A post, or one with its edges.
    ask((kind == Overlap::partial ? 7 : 1) * (i1 - i0 + 1) * (j1 - j0 + 1));
    for (int j = j0; j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) {
        if (!grid.node_known(i, j)) continue;
        const double px = grid.node_x_m(i);
        const double pz = grid.node_z_m(j);
        const double py = grid.node_y_m(i, j);
        if (kind == Overlap::partial) {
          visit_steep_edges(i, j);
          if (!holds(px, py, pz)) continue;
          bottom_ = std::min(bottom_, py);
          top_ = std::max(top_, py);
        }
        raise(px, py, pz);
      }
    }
  }

  /// A post's height above the datum.
  void take_middle(int i, int j) {
    const HeightGrid& grid = world_.grid;
    if (!grid.node_known(i, j)) return;
    const double x = grid.node_x_m(i);
    const double z = grid.node_z_m(j);
    const double y = grid.node_y_m(i, j);
    if (holds(x, y, z)) heights_.push_back(y - world_.frame.datum_y_m(x, z));
  }

  /// Edges of the mesh from a node that rise or fall by more than the margin covers: 1.5 cells hold the other
  /// end of an edge of 1.41 cells that climbs by half a cell.
  void visit_steep_edges(int i, int j) {
    const HeightGrid& grid = world_.grid;
    const double y = grid.node_y_m(i, j);
    // All six, so that an edge counts at both its ends and no direction is special.
    for (const auto& [di, dj] : {std::pair{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}}) {
      if (i + di < 0 || i + di >= grid.nx || j + dj < 0 || j + dj >= grid.nz ||
          !grid.node_known(i + di, j + dj))
        continue;
      const double other = grid.node_y_m(i + di, j + dj);
      if (std::abs(other - y) <= 0.5 * grid.cell_m) continue;
      const double x = grid.node_x_m(i);
      const double z = grid.node_z_m(j);
      if (holds(x, y, z) && holds(grid.node_x_m(i + di), other, grid.node_z_m(j + dj))) continue;
      const Reach part = reach(x, z, std::min(y, other), std::max(y, other));
      if (!part.any) continue;
      bottom_ = std::min(bottom_, part.low_y_m);
      top_ = std::max(top_, part.high_y_m);
      raise(x, part.high_y_m, z);
    }
  }

  /// Those whose circles cannot tell that they change nothing.
  void visit_buildings() {
    const LargeVector<Building>& list = world_.buildings.list;
    // Without ground in the swath, bases count as well.
    const bool all = !(bottom_ <= top_);
    constexpr std::size_t kBlock = 512;
    std::array<std::uint8_t, kBlock> idle;
    const CircleAxes axes = circle_axes(circles_, sector_);
    for (std::size_t from = 0; from < list.size(); from += kBlock) {
      const std::size_t count = std::min(kBlock, list.size() - from);
      const CircleExtent extent{axes,
                                sector_.width_rad > kPi,
                                static_cast<float>(sin_half_),
                                static_cast<float>(cos_half_),
                                static_cast<float>(sector_.r_min_m),
                                static_cast<float>(sector_.r_max_m),
                                static_cast<float>(margin_m_),
                                static_cast<float>(top_),
                                static_cast<float>(tangent_)};
      active_kernels().idle_circles(extent, circle_run(circles_, from, count), idle.data());
      ask(static_cast<std::int64_t>(count));
      for (std::size_t k = 0; k < count; ++k)
        if (all || idle[k] == 0) visit_building(list[from + k]);
    }
  }

  void visit_building(const Building& building) {
    const auto roof = static_cast<double>(building.roof_y_m);
    const std::span<const glm::vec2> outline = world_.buildings.outline(building);
    if (outline.empty()) return;
    ask(kLook * static_cast<std::int64_t>(outline.size()));
    const glm::dvec2 first(outline.front());
    double size = roof - static_cast<double>(building.base_y_m);
    bool all_inside = true;
    for (const glm::vec2& corner : outline) {
      const glm::dvec2 p(corner);
      size = std::max({size, std::abs(p.x - first.x), std::abs(p.y - first.y)});
      if (!holds(p.x, roof, p.y)) {
        all_inside = false;
        continue;
      }
      raise_building(building, p.x, roof, p.y);
    }
    // What is smaller than the margin cannot reach into the swath without its corners.
    if (!all_inside && size > margin_m_ / 2) visit_large_building(building, size);
  }

  /// Walls and roof of a building whose corners are not all in sector and swath.
  void visit_large_building(const Building& building, double size_m) {
    const Buildings& all = world_.buildings;
    const auto roof = static_cast<double>(building.roof_y_m);
    const auto base = static_cast<double>(building.base_y_m);
    const std::span<const glm::vec2> outline = all.outline(building);
    const glm::dvec2 first(outline.front());
    if (overlap(first.x, first.y, 1.5 * size_m + margin_m_, base, roof) == Overlap::none) return;
    constexpr double kMostSteps = 64;
    for (std::size_t k = 0; k < outline.size(); ++k) {
      const glm::dvec2 p(outline[k]);
      const glm::dvec2 q(outline[(k + 1) % outline.size()]);
      const double steps =
          std::clamp(std::ceil(std::hypot(q.x - p.x, q.y - p.y) / margin_m_), 1.0, kMostSteps);
      ask(static_cast<std::int64_t>(kLook * steps));
      for (double step = 0; step < steps; ++step) {
        const glm::dvec2 at = p + step / steps * (q - p);
        const Reach part = reach(at.x, at.y, base, roof);
        if (!part.any) continue;
        raise_building(building, at.x, part.high_y_m, at.y);
      }
    }
    // A roof that fills the sector from edge to edge has no corner or wall in it: ask at the far end.
    const double down = sector_.antenna_m.y - roof;
    if (!(down > 0 && down < sector_.r_max_m)) return;
    const double ground = std::sqrt(sector_.r_max_m * sector_.r_max_m - down * down);
    const glm::dvec3 far = sector_.antenna_m + sector_.world_from_antenna(0, -down, ground);
    std::vector<RoofSpan> spans;
    add_roof_spans(all, static_cast<std::uint32_t>(&building - all.list.data()), far.x, far.z, 0, 1, spans);
    const auto holds_far = [](const RoofSpan& span) { return span.near_m == 0; };
    if (std::none_of(spans.begin(), spans.end(), holds_far)) return;
    raise_building(building, far.x, roof, far.z);
  }

  const World& world_;
  const TileBounds& tiles_;
  const TileBounds& fine_tiles_;
  const BuildingCircles& circles_;
  const Sector& sector_;
  double margin_m_;
  double sin_half_;
  double cos_half_;
  double bottom_ = kInfinity;
  double top_ = -kInfinity;
  double base_ = kInfinity;  // of buildings in the swath
  double tangent_ = -kInfinity;
  std::vector<double> heights_;
};

}  // namespace

SectorExtent measure_sector(const Scene& scene, const Sector& sector) {
  return SectorScan(scene, sector).run();
}

}  // namespace obliq
