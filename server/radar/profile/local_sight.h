#pragma once
// The scene's surface in one vertical profile through the antenna: ground, roofs and the walls that face the
// antenna, as straight segments from the nadir outwards.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "server/radar/profile/roofs.h"
#include "server/radar/simd/ground/ground_cells.h"
#include "server/scene/exact_hit.h"
#include "terrain/world.h"

namespace obliq {

/// A straight segment in the profile: ground distance d from the antenna, height h above it. A wall has both
/// ends at one distance, the lower one near.
struct SurfaceSegment {
  double near_d_m = 0, near_h_m = 0;
  double far_d_m = 0, far_h_m = 0;
  double near_slope = 0;  ///< tangents of the ends' elevations; -inf at the nadir
  double far_slope = 0;
  double normal_along = 0;  ///< components of the surface's normal: outwards in the profile,
  double normal_up = 1;     ///< and up; the third one is never needed, directions lie in the profile
  double normal_length2 = 1;
  std::uint32_t face = kNoFace;
  std::uint8_t material = 0;
  float raster_gamma = 1;  ///< World::raster_gamma of the ground

  void set_ends(double near_d, double near_h, double far_d, double far_h) {
    near_d_m = near_d;
    near_h_m = near_h;
    far_d_m = far_d;
    far_h_m = far_h;
    near_slope = near_h / near_d;
    far_slope = far_h / far_d;
  }
  /// The part between two slopes, near_slope <= low <= high <= far_slope.
  SurfaceSegment between_slopes(double low, double high) const;
  /// The part that is nearer than a distance between its ends.
  SurfaceSegment nearer_than(double d_m) const;
};

/// A point of the profile that a ray says is visible.
struct SightPoint {
  double d_m = 0;  ///< ground distance from the antenna
  double h_m = 0;  ///< above the antenna
  double slope = 0;
};

/// Cells walked behind a crest, or in front of a foot, to find the surface that is visible next.
constexpr int kLook_cells = 16;

/// The surface in a profile, and what a plate covers of it: what is visible next to a ray's hit, in the ray's
/// own profile. Both walks are local: they end at the given slope or distance, at a void, or where nothing
/// has been visible for kLook_cells, so that their cost follows the plate and not the scene. Keeps a
/// reference to the world.
class LocalSurface {
 public:
  LocalSurface(const World& world, const glm::dvec3& antenna_m);

  /// Turns the profile. `stretches`: disjoint and sorted, kept by reference until the next turn.
  void aim(double sin_bearing, double cos_bearing, const std::vector<RoofSpan>& stretches);

  /// Appends the visible segments beyond `from`, outwards, with slopes from from.slope to `to_slope`, up to
  /// distance `to_d_m`.
  void walk_out(const SightPoint& from, double to_slope, double to_d_m, std::vector<SurfaceSegment>& visible);

  /// Appends the visible segments nearer than `from`, inwards, with slopes from from.slope down to
  /// `to_slope`. What rises in front hides what lies behind.
  void walk_in(const SightPoint& from, double to_slope, double to_d_m, std::vector<SurfaceSegment>& visible);

 private:
  template <class Begin, class Segment>
  void walk(bool inwards, double d_m, const Begin& begin, const Segment& segment);
  void cut_surface(const Cells<double>& cell, const TriangleCut<double>& cut, double rise, double d0,
                   double d1);
  void add_wall(const RoofSpan& roof, double low);
  void add_roof(const RoofSpan& roof, double d0, double d1);

  const World& world_;
  const std::vector<RoofSpan>* stretches_ = nullptr;
  glm::dvec3 antenna_m_;
  GroundView ground_;
  ProfileRates<double> outwards_{}, inwards_{};
  std::vector<SurfaceSegment> segments_;  // of the current triangle, outwards
};

}  // namespace obliq
