#pragma once
// One column of the sweep: the azimuths that one vertical plane stands for, and the buildings in them.
//
// The column's base plane, at its centre, sees the terrain alone. Buildings are narrower than columns, so
// each gets strands of its own: stretches of the column's bearings, with a vertical plane at the centre of
// each, from the building outwards until the terrain has come out of its shadow. A strand's plane starts with
// the exact horizon of its own bearing, so a house on a slope stands right and none that shows is missed.
// Where strands are, the base plane stands for what they leave of the column: bearings are counted in whole
// ticks, so the shares add up to the column exactly, and to nothing exactly where strands cover it.
#include <cstdint>
#include <vector>

#include "server/radar/geometry/silhouettes.h"
#include "server/radar/profile/horizon.h"
#include "server/radar/sweep/segment_sampler.h"
#include "server/radar/sweep/sweep_ground.h"

namespace obliq {

/// A stretch of a column's bearings, in ticks from its left edge.
struct TickRange {
  std::int64_t from = 0;
  std::int64_t to = 0;
  std::int64_t size() const { return to - from; }
};

class SweepColumn {
 public:
  static constexpr std::int64_t kTicks = std::int64_t{1} << 40;  ///< in a column

  /// What a strand stood for: its bearings, and from where to where (ground distances).
  struct StrandRecord {
    TickRange ticks;
    double from_m;
    double to_m;  ///< infinite: to the end of the swath
  };

  /// `start_rad` is the column's left edge, an offset from the sector's centre.
  SweepColumn(const ScenePlan& plan, int azimuth_bin, double start_rad, double width_rad);

  /// Marches the strands of all buildings and leaves what the base plane stands for. `silhouettes`: of the
  /// buildings that may overlap the column.
  void start(const std::vector<Silhouette>& silhouettes, SegmentSampler& sampler);

  const GroundShare& base() const { return base_; }

  int planes() const { return planes_; }
  const std::vector<StrandRecord>& strands() const { return records_; }

 private:
  struct Obstacle {
    std::uint32_t building;
    double near_m;
    double far_m;
    double slope;      // no part of the building stands above it
    double all_far_m;  // the greatest of this one and all before it
    double all_slope;
    TickRange ticks;
    std::vector<std::int64_t> cuts;  // from, corners, to
  };
  struct Strand {
    TickRange ticks;
    double from_m;
    LineOfSight plane;
  };

  void find_obstacles(const std::vector<Silhouette>& silhouettes);
  void add_obstacle(std::size_t index, SegmentSampler& sampler);
  void advance(double to_m, SegmentSampler& sampler);
  void march(Strand& strand, double to_m, GroundWalk::Last last, SegmentSampler& sampler);
  LineOfSight plane_at(TickRange ticks, double from_m, std::size_t n_obstacles);
  enum class Look { shows, nearly, hidden };
  Look look(const LineOfSight& plane, std::size_t obstacle, double width_rad);
  void consider(TickRange ticks, std::size_t obstacle, int halvings, std::vector<Strand>& fresh);
  void finish(const Strand& strand, double at_m);
  void plan_base();

  double offset_rad(TickRange ticks) const {
    return start_rad_ + 0.5 * static_cast<double>(ticks.from + ticks.to) * tick_rad_;
  }
  PlaneShare share_of(TickRange ticks, SinCos bearing) const;

  const ScenePlan& plan_;
  int azimuth_bin_;
  double start_rad_;
  double tick_rad_;
  HorizonBound ridge_;
  int planes_ = 0;
  std::vector<Obstacle> obstacles_;
  std::vector<Strand> active_;  // disjoint, by bearing
  std::vector<StrandRecord> records_;
  GroundShare base_;
  std::vector<RoofSpan> spans_;
};

}  // namespace obliq
