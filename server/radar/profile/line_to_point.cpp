#include "server/radar/profile/line_to_point.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/radar/profile/ground_walk.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/profile/tile_walk.h"
#include "server/radar/simd/kernels.h"
#include "server/scene/tolerances.h"

namespace obliq {
namespace {

static_assert(BuildingIndex::kCells == TileBounds::kFineCells, "a square is a block of the index");

/// Nearer than this in the plane, a point lies straight above or below the antenna.
constexpr double kStraightDown_m = 1e-3;

/// The vertical profile from the antenna to the point.
struct Line {
  const HeightGrid& grid;
  glm::dvec3 antenna_m;
  glm::dvec3 point_m;
  double length_m;
  SinCos bearing{0, 1};
  double per_x = HUGE_VAL, per_z = 1;  ///< ground distance per metre of x and z

  Line(const HeightGrid& of, const glm::dvec3& antenna, const glm::dvec3& point)
      : grid(of), antenna_m(antenna), point_m(point) {
    const double x = point.x - antenna.x, z = point.z - antenna.z;
    length_m = std::sqrt(x * x + z * z);
    if (length_m > 0) bearing = {x / length_m, z / length_m};
    per_x = 1 / bearing.sin;
    per_z = 1 / bearing.cos;
  }

  GroundWalk walk(double from_m, double to_m) const {
    return GroundWalk(grid, antenna_m, bearing.sin, bearing.cos, from_m, to_m);
  }

  /// Calls visit(i, j, near_m, far_m) for squares of a level between two distances within the grid, inwards,
  /// until it returns false.
  template <class Visit>
  bool inwards(const SurfaceBounds::Level& level, double from_m, double to_m, const Visit& visit) const {
    const double square_m = level.cells * grid.cell_m;
    int i = tile_of(antenna_m.x + to_m * bearing.sin, grid.x0_m, square_m, level.nx);
    int j = tile_of(antenna_m.z + to_m * bearing.cos, grid.z0_m, square_m, level.nz);
    for (double far = to_m; far > from_m && i >= 0 && j >= 0 && i < level.nx && j < level.nz;) {
      const double x = grid.x0_m + (bearing.sin > 0 ? i : i + 1) * square_m;
      const double z = grid.z0_m + (bearing.cos > 0 ? j : j + 1) * square_m;
      const double to_x = bearing.sin != 0 ? (x - antenna_m.x) * per_x : -HUGE_VAL;
      const double to_z = bearing.cos != 0 ? (z - antenna_m.z) * per_z : -HUGE_VAL;
      const double near = std::clamp(std::max(to_x, to_z), from_m, far);
      if (!visit(i, j, near, far)) return false;
      if (to_x > to_z) {
        i += bearing.sin > 0 ? -1 : 1;
      } else {
        j += bearing.cos > 0 ? -1 : 1;
      }
      far = near;
    }
    return true;
  }
};

/// Raises an obstacle by ground and roofs, square by square, so that most squares need no look: inwards where
/// all lies under the antenna, since far ground then stands higher than near ground; else first where
/// something may stand highest.
class Look {
 public:
  Look(const Scene& scene, const Line& line)
      : scene_(scene),
        bounds_(scene.bounds()),
        line_(line),
        ground_(ground_view(line.grid, line.antenna_m)),
        from_above_(bounds_.highest_m() <= line.antenna_m.y) {}

  const Obstacle& highest() const { return highest_; }

  void look(std::size_t level_number, double from_m, double to_m) {
    const SurfaceBounds::Level& level = bounds_.levels()[level_number];
    const std::size_t first = squares_.size();
    line_.inwards(level, from_m, to_m, [&](int i, int j, double near, double far) {
      const auto top = static_cast<double>(level.highest_m[level.index(i, j)]) - line_.antenna_m.y;
      if (!may_rise(top, near, far)) return true;
      if (from_above_) {
        look_at_square(level_number, i, j, near, far);
      } else {
        squares_.push_back({i, j, near, far, top, top / (top > 0 ? near : far)});
      }
      return true;
    });
    const std::size_t end = squares_.size();
    std::sort(squares_.begin() + static_cast<std::ptrdiff_t>(first), squares_.end(),
              [](const Square& a, const Square& b) { return a.slope > b.slope; });
    for (std::size_t k = first; k < end; ++k) {
      const Square s = squares_[k];
      if (may_rise(s.top, s.near, s.far)) look_at_square(level_number, s.i, s.j, s.near, s.far);
    }
    squares_.resize(first);
  }

  /// The far end need not lie on an edge of the mesh.
  void look_at_end() {
    const double y = line_.grid.height_at_m(line_.point_m.x, line_.point_m.z);
    if (!std::isnan(y)) raise(line_.length_m, y - line_.antenna_m.y, false);
  }

  // For GroundWalk: a straight segment is highest at one of its ends.
  void ground(const GroundSegment& segment) {
    raise(segment.d0_m, segment.start_m + segment.rise * segment.d0_m - line_.antenna_m.y, false);
    raise(segment.d1_m, segment.start_m + segment.rise * segment.d1_m - line_.antenna_m.y, false);
  }
  static void gap(double, double) {}
  static bool enough() { return false; }

 private:
  struct Square {
    int i, j;
    double near, far;
    double top;    ///< over the antenna
    double slope;  ///< none of it stands at a greater elevation
  };

  void look_at_square(std::size_t level_number, int i, int j, double near, double far) {
    if (level_number > 0) return look(level_number - 1, near, far);
    const SurfaceBounds::Level& level = bounds_.levels().front();
    look_at_ground(level.whole[level.index(i, j)] != 0, near, far);
    look_at_roofs(i, j, near, far);
  }

  /// Whether anything no higher than `top` between two distances may stand above what was found.
  bool may_rise(double top, double near, double far) const {
    return std::isfinite(top) && !hides(top > 0 ? near : far, top);
  }
  bool hides(double d, double h) const { return h * highest_.d_m < highest_.h_m * d; }

  void raise(double d, double h, bool building) {
    // Of two at one elevation the nearer counts.
    const bool higher = h * highest_.d_m > highest_.h_m * d;
    if (d > 0 && (higher || highest_.d_m == 0 || (!hides(d, h) && d <= highest_.d_m)))
      highest_ = {d, h, building};
  }

  void look_at_ground(bool whole, double near, double far) {
    if (whole) {
      const HorizonPoint found =
          active_kernels().highest_ground(ground_, {line_.bearing.sin, line_.bearing.cos, near, far});
      raise(found.d_m, found.h_m, false);
    } else {
      line_.walk(near, far).advance(far, *this);
    }
  }

  /// Of buildings that reach into the square (i, j) of the smallest, which is a block of the index or lies in
  /// one.
  void look_at_roofs(int i, int j, double near, double far) {
    if (!may_rise(bounds_.highest_roof_m(i, j) - line_.antenna_m.y, near, far)) return;
    const Buildings& all = scene_.world().buildings;
    const BuildingCircles& circles = scene_.circles();
    const double square_m = bounds_.levels().front().cells * line_.grid.cell_m;
    const glm::dvec2 antenna(line_.antenna_m.x, line_.antenna_m.z);
    const auto meet = [&](std::uint32_t b) {
      const double roof = static_cast<double>(circles.roof_y_m[b]) - line_.antenna_m.y;
      if (!may_rise(roof, near, far)) return false;
      const double aside = (static_cast<double>(circles.x_m[b]) - antenna.x) * line_.bearing.cos -
                           (static_cast<double>(circles.z_m[b]) - antenna.y) * line_.bearing.sin;
      if (std::abs(aside) > static_cast<double>(circles.radius_m[b]) + kMargin_m) return false;
      spans_.clear();
      add_roof_spans(all, b, antenna.x, antenna.y, line_.bearing.sin, line_.bearing.cos, spans_);
      for (const RoofSpan& span : spans_) {
        if (span.near_m >= line_.length_m - kTouching_m) continue;
        raise(roof > 0 ? span.near_m : std::min(span.far_m, line_.length_m), roof, true);
      }
      return false;
    };
    (void)scene_.building_index().any_near(line_.grid.x0_m + (i + 0.5) * square_m,
                                           line_.grid.z0_m + (j + 0.5) * square_m, meet);
  }

  const Scene& scene_;
  const SurfaceBounds& bounds_;
  const Line& line_;
  const GroundView ground_;
  const bool from_above_;
  Obstacle highest_;
  std::vector<Square> squares_;  ///< to be looked at, of all levels, sorted
  std::vector<RoofSpan> spans_;
};

/// Whether a profile meets a cell that is not known.
struct FindGap {
  bool found = false;
  static void ground(const GroundSegment&) {}
  void gap(double from_m, double to_m) { found = found || to_m - from_m > kMargin_m; }
  bool enough() const { return found; }
};

bool meets_gap(const SurfaceBounds& bounds, const Line& line, std::size_t level_number, double from_m,
               double to_m) {
  const SurfaceBounds::Level& level = bounds.levels()[level_number];
  return !line.inwards(level, from_m, to_m, [&](int i, int j, double near, double far) {
    if (level.whole[level.index(i, j)] != 0) return true;
    if (level_number > 0) return !meets_gap(bounds, line, level_number - 1, near, far);
    FindGap gap;
    line.walk(near, far).advance(far, gap);
    return !gap.found;
  });
}

}  // namespace

Obstacle highest_before(const Scene& scene, const glm::dvec3& antenna_m, const glm::dvec3& point_m) {
  const Line line(scene.world().grid, antenna_m, point_m);
  if (line.length_m < kStraightDown_m) return {};
  const GroundWalk whole = line.walk(0, line.length_m);
  if (whole.done()) return {};
  Look look(scene, line);
  look.look_at_end();
  look.look(scene.bounds().levels().size() - 1, whole.at_m(), std::min(line.length_m, whole.end_m()));
  return look.highest();
}

bool passes_unknown(const Scene& scene, const glm::dvec3& antenna_m, const glm::dvec3& point_m) {
  const SurfaceBounds& bounds = scene.bounds();
  const Line line(scene.world().grid, antenna_m, point_m);
  if (line.length_m < kStraightDown_m) return false;
  const GroundWalk whole = line.walk(0, line.length_m);
  if (whole.done() || whole.at_m() > kMargin_m || whole.end_m() < line.length_m - kMargin_m) return true;
  return !bounds.whole() && meets_gap(bounds, line, bounds.levels().size() - 1, whole.at_m(), whole.end_m());
}

}  // namespace obliq
