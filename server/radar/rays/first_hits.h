#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "server/radar/rays/clearance.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/scene_plan.h"
#include "server/scene/embree_tracer.h"

namespace obliq {

/// First hits on the ground of a wedge's rays in any direction. Each ray walks the grid by itself, but starts
/// where its clearance ends: a few cells. Rays that might meet a building first are left to a ray tracer.
class GroundFirstHits {
 public:
  /// beyond_swath: looks for buildings there too, though none is binned.
  GroundFirstHits(const ScenePlan& plan, AzimuthRange range, bool beyond_swath);

  /// As EmbreeTracer::trace, of rays of the wedge, but for the rays that it returns: those are left, in the
  /// batch's packet order. Valid until the next call.
  std::span<const std::uint16_t> trace(const RayBatch& rays, RoughHit* hits);

 private:
  GroundClearance* clearance_of(std::size_t bin, const glm::dvec3& direction);
  double unknown_from_m(const glm::dvec3& direction) const;
  double on_grid_m(double from_m, const glm::dvec3& direction) const;

  const ScenePlan& plan_;
  int first_bin_;
  bool beyond_swath_;
  std::size_t clearances_a_bin_;
  double bin_turns_;  // an azimuth bin's width
  bool wide_;         // much of a turn
  // Of the azimuth bins:
  std::vector<double> middle_rad_;
  std::vector<std::size_t> last_clearance_;  // that a ray lay in
  std::vector<SinCos> edges_;                // between clearances, from the left edge of the first
  std::vector<GroundClearance> clearances_;
  std::vector<RoofClearance> roofs_;  // of the azimuth bins; empty where there are no buildings
  // Of the batch's rays:
  std::array<GroundClearance*, kBatch> clearance_;
  std::array<double, kBatch> from_m_;
  std::array<double, kBatch> roof_m_;
  std::array<double, kBatch> range_m_;
  std::array<std::uint16_t, kBatch> walking_;
  std::array<std::uint16_t, kBatch> left_;
};

/// First hits of the rays of one wedge, found as the scene's RayMethod says: all by Embree, or by marching.
/// Then rays walk the ground one by one, and Embree traces those that come near buildings.
class FirstHits {
 public:
  /// beyond_swath: finds hits there too, for textures.
  FirstHits(const ScenePlan& plan, AzimuthRange range, bool beyond_swath = false);

  /// As EmbreeTracer::trace, of rays that PerspectiveRays made for the wedge.
  void trace(const RayBatch& rays, RoughHit* hits);

  /// Whether Embree traced ray k of the last batch: such a ray may have leaked through the mesh. A marched
  /// ray never leaks; beyond the swath, where nothing is binned, a march ignores buildings.
  bool by_embree(std::size_t k) const { return by_embree_[k]; }

 private:
  const ScenePlan& plan_;
  std::optional<GroundFirstHits> ground_;
  std::array<bool, kBatch> by_embree_{};
};

}  // namespace obliq
