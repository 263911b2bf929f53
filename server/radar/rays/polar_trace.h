#pragma once
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/profile/profile_rays.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/samples.h"

namespace obliq {

/// What the polar frustum's rays of one wedge meet first. Its columns are vertical planes, so that a march of
/// each answers all its rays, ten times sooner than a ray tracer does one by one. Columns are marched when
/// their rays come, some at a time, and no more rows of them than keep a wedge's memory small.
class PolarTrace {
 public:
  /// Answers that are kept of a wedge, at most, as long as a column has more than kLeastRows.
  static constexpr std::size_t kMostAnswers = std::size_t{1} << 19;
  static constexpr std::size_t kLeastRows = 32;
  static constexpr std::size_t kBytesAnAnswer = sizeof(double) + sizeof(std::uint32_t);

  PolarTrace(const FramePlan& plan, AzimuthRange range);

  /// As EmbreeTracer::trace, of rays that PolarRays made for the wedge.
  void trace(const RayBatch& rays, RoughHit* hits);

 private:
  /// Neighbouring columns that are marched together.
  struct Group {
    ProfileRays::Run rows{0, 0};           // that are answered
    std::vector<std::uint32_t> buildings;  // that its columns may meet
  };

  void begin();
  void share_out_buildings();
  void march(std::size_t group, std::size_t row);
  RoughHit walk(const RayBatch& rays, std::size_t k) const;
  std::uint32_t triangle_of(std::uint32_t face) const;

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

}  // namespace obliq
