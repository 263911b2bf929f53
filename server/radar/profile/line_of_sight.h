#pragma once
// What an antenna sees of one vertical profile of zero width: the terrain's triangles, walls and roofs,
// exact.
#include <glm/vec3.hpp>
#include <vector>

#include "server/radar/profile/ground_walk.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/simd/ground/horizon.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "server/scene/exact_hit.h"
#include "server/scene/tolerances.h"
#include "terrain/world.h"

namespace obliq {

/// A straight segment of the surface's cut through a vertical profile: (d, h) = (d_m, h_m) + t (rate_d,
/// rate_h), h above the antenna, t from t0 (lower elevation) to t1 (higher).
struct VisibleSegment {
  /// Where a wall begins: where something in front ends, or at the ground or the roof that it stands on.
  enum class Foot : std::uint8_t { hidden, ground, roof };

  double d_m;
  double h_m;
  double rate_d;
  double rate_h;
  double t0;
  double t1;
  double plane_distance_m;  ///< of the antenna from the triangle's plane: cos(incidence) = this / slant range
  std::uint32_t face;       ///< building face; kNoFace on ground
  std::uint8_t material;
  bool upper;  ///< ground only, as in GroundSegment
  int i;       ///< ground cell
  int j;
  bool wall;
  double normal_x;  ///< of a wall: unit, outwards
  double normal_z;
  double nearest_m;  ///< of a wall: ground distances of its nearest and its farthest point
  double farthest_m;
  Foot foot;
  float raster_gamma = 1;  ///< World::raster_gamma of the ground

  double ground_range_m(double t) const { return d_m + t * rate_d; }
  double height_m(double t) const { return h_m + t * rate_h; }
};

/// Marches one vertical profile outwards and reports every segment of surface that rises above all that lies
/// nearer. The world is a height field (terrain, and prisms that stand on it), so the segments are disjoint
/// in elevation and come in rising order. Only surfaces that face the antenna are lit.
class LineOfSight {
 public:
  /// bearing: sin and cos of the world angle. Starts at from_m, where `horizon` stands for all that is
  /// nearer; `spans` are the footprints that the profile crosses (those that end before from_m are ignored).
  /// Cells are marched whole, none that begins beyond reach_m and all footprints: a wall that begins in the
  /// swath may stand beyond it in this profile.
  LineOfSight(const World& world, const glm::dvec3& antenna_m, SinCos bearing, double from_m, double reach_m,
              const Horizon<double>& horizon, std::vector<RoofSpan> spans)
      : world_(&world),
        antenna_m_(antenna_m),
        bearing_(bearing),
        cells_per_m_(1 / world.grid.cell_m),
        walk_(world.grid, antenna_m, bearing.sin, bearing.cos, from_m, kInfinity, reach_m),
        horizon_(horizon),
        spans_(std::move(spans)) {
    cut_roofs(from_m);
  }

  const SinCos& bearing() const { return bearing_; }
  const Horizon<double>& horizon() const { return horizon_; }
  const std::vector<RoofSpan>& spans() const { return spans_; }
  double at_m() const { return walk_.at_m(); }
  bool done() const { return walk_.done(); }
  /// Nothing of a building can be seen or casts its shadow any more: the terrain has risen above the horizon
  /// that the last roof set, and no roof is ahead.
  bool out_of_shadow() const { return step_ == steps_.size() && !horizon_.building; }

  /// More footprints that the profile crosses, all beyond at_m().
  void add(const std::vector<RoofSpan>& spans) {
    spans_.insert(spans_.end(), spans.begin(), spans.end());
    cut_roofs(walk_.at_m());
  }

  /// Whether another building's roof covers all of a footprint's stretch.
  bool covers(const RoofSpan& span) const;
  /// Raises a horizon by the other buildings' roofs up to where a stretch begins.
  void raise_by_roofs(Horizon<double>& horizon, const RoofSpan& before) const;

  /// Marches to `to_m` (see GroundWalk::Last) or until sink.full() after a cell. Calls
  /// sink.visible(const VisibleSegment&).
  template <class Sink>
  void advance(double to_m, Sink& sink, GroundWalk::Last last = GroundWalk::Last::cut) {
    Visit<Sink> visit{*this, sink};
    walk_.advance(to_m, visit, last);
  }

 private:
  template <class Sink>
  struct Visit {
    LineOfSight& profile;
    Sink& sink;
    void ground(const GroundSegment& segment) {
      if (profile.step_ < profile.steps_.size() && profile.steps_[profile.step_].near_m <= segment.d1_m) {
        profile.with_roofs(segment.d0_m, segment.d1_m, &segment, sink);
      } else {
        profile.see_ground(segment, segment.d0_m, segment.d1_m, sink);
      }
    }
    void gap(double d0, double d1) {
      if (profile.step_ < profile.steps_.size() && profile.steps_[profile.step_].near_m <= d1)
        profile.with_roofs(d0, d1, nullptr, sink);
    }
    bool enough() const { return sink.full(); }
  };

  /// A segment of sloping surface h = start + rise d.
  template <class Emit>
  void see(double d0, double d1, double start, double rise, bool building, Emit&& emit) {
    const auto seen = horizon_.pass(true, start, rise, d0, d1, building);
    if (seen.any) emit(seen.from, d1);
  }

  template <class Sink>
  void see_ground(const GroundSegment& ground, double d0, double d1, Sink& sink) {
    const double start = ground.start_m - antenna_m_.y;
    see(d0, d1, start, ground.rise, false, [&](double from, double to) {
      const double slope_x = ground.per_cell_x_m * cells_per_m_;
      const double slope_z = ground.per_cell_z_m * cells_per_m_;
      const double steepness = std::sqrt(1 + slope_x * slope_x + slope_z * slope_z);
      sink.visible(VisibleSegment{0, start, 1, ground.rise, from, to, -start / steepness, kNoFace,
                                  world_->material_of_cell(ground.i, ground.j), ground.upper, ground.i,
                                  ground.j, false, 0, 0, 0, 0, VisibleSegment::Foot::hidden,
                                  world_->raster_gamma_of_cell(ground.i, ground.j)});
    });
  }

  template <class Sink>
  void see_wall(const RoofSpan& step, Sink& sink) {
    const double d = step.near_m;
    const double top = step.roof_y_m - antenna_m_.y;
    // Everything in front reaches up to the horizon; only over unknown ground does the wall begin at its
    // base.
    const Building& building = world_->buildings.list[step.building];
    const double base = static_cast<double>(building.base_y_m) - antenna_m_.y;
    if (!(d > 0) || horizon_.hides(d, top)) return;
    const double low = horizon_.d_m > 0 ? std::max(base, horizon_.h_m / horizon_.d_m * d) : base;
    const auto foot = !(horizon_.d_m > d - kTouching_m) ? VisibleSegment::Foot::hidden
                      : horizon_.building               ? VisibleSegment::Foot::roof
                                                        : VisibleSegment::Foot::ground;
    const WallPlane wall = wall_plane(world_->buildings, step.wall, antenna_m_.x, antenna_m_.z);
    if (low < top && wall.distance_m > 0)
      sink.visible(VisibleSegment{d, 0, 0, 1, low, top, wall.distance_m, step.wall, building.material, false,
                                  0, 0, true, wall.normal_x, wall.normal_z, wall.nearest_m, wall.farthest_m,
                                  foot});
    horizon_.raise(d, top, true);
  }

  template <class Sink>
  void see_roof(const RoofSpan& step, double d0, double d1, Sink& sink) {
    const double start = step.roof_y_m - antenna_m_.y;
    see(d0, d1, start, 0, true, [&](double from, double to) {
      const Building& building = world_->buildings.list[step.building];
      sink.visible(VisibleSegment{0, start, 1, 0, from, to, -start, building.first_face, building.material,
                                  false, 0, 0, false, 0, 0, 0, 0, VisibleSegment::Foot::hidden});
    });
  }

  /// [d0, d1] of a profile with roofs in it: the higher of ground and roof. No ground over a gap.
  template <class Sink>
  void with_roofs(double d0, double d1, const GroundSegment* ground, Sink& sink) {
    const auto see_bare = [&](double from, double to) {
      if (ground) see_ground(*ground, from, to, sink);
    };
    cut_at_roofs(steps_, step_, d0, d1, see_bare, [&](const RoofSpan& step, double from, double to) {
      if (step_ >= next_wall_ && step.wall != kNoFace) see_wall(step, sink);
      next_wall_ = step_ + 1;
      const auto see_top = [&](double d, double end) { see_roof(step, d, end, sink); };
      if (ground) {
        over_roof(ground->start_m, ground->rise, step.roof_y_m, from, to, see_bare, see_top);
      } else {
        see_top(from, to);
      }
    });
  }

  /// Keeps the footprints that end beyond from_m.
  void cut_roofs(double from_m);
  const World* world_;
  glm::dvec3 antenna_m_;
  SinCos bearing_;
  double cells_per_m_;
  GroundWalk walk_;
  Horizon<double> horizon_;
  std::vector<RoofSpan> spans_;
  std::vector<RoofSpan> steps_;
  std::size_t step_ = 0;
  std::size_t next_wall_ = 0;  // the first step whose wall has not been seen
};

}  // namespace obliq
