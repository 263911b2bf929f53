#pragma once
#include <array>
#include <optional>
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/profile/profile_rays.h"
#include "server/radar/rays/ground_first_hits.h"
#include "server/radar/rays/ray_batch.h"

namespace obliq {

/// What the polar frustum's rays of one wedge meet first. Its columns are vertical planes, so that a march of
/// each answers all its rays, ten times sooner than a ray tracer does one by one. Columns are marched when
/// their rays come, some at a time, and no more rows of them than keep a wedge's memory small.
class PolarFirstHits {
 public:
  /// Answers that are kept of a wedge, at most, as long as a column has more than kLeastRows.
  static constexpr std::size_t kMostAnswers = std::size_t{1} << 19;
  static constexpr std::size_t kLeastRows = 32;
  static constexpr std::size_t kBytesAnAnswer = sizeof(double) + sizeof(std::uint32_t);

  PolarFirstHits(const FramePlan& plan, AzimuthRange range);

  /// As EmbreeTracer::trace, of rays that PolarRays generated for the wedge.
  void trace(const RayBatch& rays, RoughHit* hits);

 private:
  /// Neighbouring columns that are marched together.
  struct Group {
    SweptRays::Run rows{0, 0};             // that are answered
    std::vector<std::uint32_t> buildings;  // that its columns may meet
  };

  void begin();
  void share_out_buildings();
  void march(std::size_t group, std::size_t row);
  RoughHit walk(const RayBatch& rays, std::size_t k) const;
  std::uint32_t triangle_of(std::uint32_t face) const;

  const FramePlan& plan_;
  AzimuthRange range_;
  const SweptRays& rays_;
  int first_column_ = 0;
  std::vector<SinCos> bearings_;  // [columns]
  std::vector<Group> groups_;     // of kMostPlanes columns each
  std::size_t most_rows_ = 0;
  std::vector<double> slant_range_m_;   // [groups][kMostPlanes][rows]
  std::vector<std::uint32_t> surface_;  // the same
};

/// What the rays of one wedge meet first, found as the scene's RayMethod says. With a march, the columns of
/// the polar frustum are marched as the vertical planes that they are, rays of the others walk the ground one
/// by one, and Embree traces those that come near buildings.
class FirstHits {
 public:
  /// beyond_swath: for textures, which show what no bin holds (of the polar frustum still without buildings).
  FirstHits(const FramePlan& plan, AzimuthRange range, bool beyond_swath = false);

  /// As EmbreeTracer::trace, of rays that the plan's RaySource made for the wedge.
  void trace(const RayBatch& rays, RoughHit* hits);

  /// Whether Embree traced ray k of the last batch: it may have leaked through the mesh. A march lets no ray
  /// through; beyond the swath, where nothing is binned, it leaves buildings out.
  bool by_embree(std::size_t k) const { return by_embree_[k]; }

 private:
  const FramePlan& plan_;
  std::optional<PolarFirstHits> polar_;
  std::optional<GroundFirstHits> ground_;
  std::array<bool, kBatch> by_embree_{};
};

}  // namespace obliq
