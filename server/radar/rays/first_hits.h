#pragma once
#include <array>
#include <optional>
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/profile/profile_rays.h"
#include "server/radar/rays/ground_first_hits.h"
#include "server/radar/rays/ray_batch.h"

namespace obliq {

/// First hits of the polar frustum's rays of one wedge. Its columns are vertical planes, so that one march
/// finds the hits of all rays of a column, ten times sooner than a ray tracer does one by one. Columns are
/// marched when their rays come, some at a time, and no more rows of them than keep a wedge's memory small.
class PolarFirstHits {
 public:
  /// Hits that are kept of a wedge, at most, unless a column would have fewer than kLeastRows.
  static constexpr std::size_t kMostKept = std::size_t{1} << 19;
  static constexpr std::size_t kLeastRows = 32;
  static constexpr std::size_t kBytesAHit = sizeof(double) + sizeof(std::uint32_t);

  PolarFirstHits(const FramePlan& plan, AzimuthRange range);

  /// As EmbreeTracer::trace, of rays that PolarRays generated for the wedge.
  void trace(const RayBatch& rays, RoughHit* hits);

 private:
  /// Neighbouring columns that are marched together.
  struct Group {
    ProfileRays::Run rows{0, 0};           // whose hits are kept
    std::vector<std::uint32_t> buildings;  // that its columns may hit
  };

  void begin();
  void share_out_buildings();
  void march(std::size_t group, std::size_t row);
  RoughHit walk(const RayBatch& rays, std::size_t k) const;

  const FramePlan& plan_;
  AzimuthRange range_;
  const ProfileRays& rays_;
  int first_column_ = 0;
  std::vector<SinCos> bearings_;  // [columns]
  std::vector<Group> groups_;     // of kMostProfiles columns each
  std::size_t most_rows_ = 0;
  std::vector<double> slant_range_m_;   // [groups][kMostProfiles][rows]
  std::vector<std::uint32_t> surface_;  // the same
};

/// First hits of the rays of one wedge, found as the scene's RayMethod says: by Embree, or by marching. A
/// march takes the polar frustum's columns as the vertical planes that they are; rays of the other frusta
/// walk the ground one by one, and Embree traces those that come near buildings.
class FirstHits {
 public:
  /// beyond_swath: finds hits there too, for textures (of the polar frustum on the ground alone).
  FirstHits(const FramePlan& plan, AzimuthRange range, bool beyond_swath = false);

  /// As EmbreeTracer::trace, of rays that the plan's RaySource made for the wedge.
  void trace(const RayBatch& rays, RoughHit* hits);

  /// Whether Embree traced ray k of the last batch: such a ray may have leaked through the mesh. A marched
  /// ray never leaks; beyond the swath, where nothing is binned, a march ignores buildings.
  bool by_embree(std::size_t k) const { return by_embree_[k]; }

 private:
  const FramePlan& plan_;
  std::optional<PolarFirstHits> polar_;
  std::optional<GroundFirstHits> ground_;
  std::array<bool, kBatch> by_embree_{};
};

}  // namespace obliq
