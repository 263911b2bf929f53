#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/profile/roofs.h"
#include "server/radar/profile/stretch_count.h"
#include "server/radar/scene_plan.h"
#include "server/radar/simd/ground/ground_echoes.h"

namespace obliq {

/// Labels::returns of a wedge as the sweep's planes see it: stretches of ground as they come, and between
/// them the walls and roofs that each plane crosses. As count_returns (visibility/returns.h), but that a roof
/// never lies under ground.
class SweptReturns {
 public:
  SweptReturns(const ScenePlan& plan, int planes);

  /// Buildings that a plane of an azimuth bin may cross; `profile`: the bin's place in the wedge. None at
  /// first.
  std::vector<std::uint32_t>& buildings(int plane, int profile) {
    return buildings_[static_cast<std::size_t>(plane * kWedgeAzimuthBins + profile)];
  }

  /// A run of stretches begins: a plane of an azimuth bin.
  void start(std::size_t run, int plane, int profile, SinCos bearing);
  /// Some of the runs cross roofs: they need the stretches' heights.
  bool any_roofs() const;
  void add(const GroundStretches& stretches);
  /// The runs end. profiles: azimuth bins of the wedge.
  void end_planes();

  /// Writes what was counted to the block's labels.
  void write(BinBlock& block) const;

  static std::int64_t bytes(int n_range) {
    return std::int64_t{n_range} * (GroundEchoes::kRuns + kWedgeAzimuthBins);
  }

 private:
  /// Ground distance, and height above the antenna.
  struct Point {
    double d = 0, h = 0;
  };
  struct Run {
    explicit Run(const RangeAxis& bins) : count(bins) {}
    StretchCount count;
    bool begun = false;
    std::vector<RoofSpan> roofs;  // disjoint, by distance
    std::size_t next = 0;
    Point ground;           // the end of what was passed last
    double roof_slope = 0;  // the greatest of what roofs hide
    double ground_end_m = 0;
    double roof_end_m = 0;  // of the roof that was seen last
  };
  static void see_ground(Run& run, int bin, const Point& from, const Point& end);
  void see_building(Run& run, const RoofSpan& roof, bool on_ground) const;

  const ScenePlan& plan_;
  std::vector<Run> runs_;
  std::vector<std::vector<std::uint32_t>> buildings_;  // [planes][8]
  std::vector<std::uint8_t> most_;                     // [8][n_range]
};

}  // namespace obliq
