#pragma once
#include <span>
#include <vector>

#include "server/radar/echo/echo_cells.h"
#include "server/radar/echo/scattering.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/simd/buildings/sub_columns.h"
#include "server/radar/sweep/corner_view.h"
#include "server/radar/sweep/near_buildings.h"
#include "server/radar/sweep/segment_sampler.h"

namespace obliq {

/// The near buildings of one azimuth bin, exactly: the bin is divided into strips at their corners, and a
/// vertical plane in the middle of each strip passes their walls and roofs outwards. Ground is that of the
/// bin's planes: what stands in front of a wall, and what the buildings hide of it.
class NearView {
 public:
  /// far_m: buildings that begin beyond it are left out.
  NearView(const ScenePlan& plan, const NearBuildings& buildings, const ScatteringTable& scattering,
           double far_m);

  /// All near buildings of an azimuth bin; `profile`: its place in the wedge. False: there are none.
  /// Adds their corners to `corners`, where those are wanted.
  bool see(int azimuth_bin, int profile, const SubColumns& columns, CornerView& corners, EchoCells& cells);

  /// What they hide at an offset from the sector's centre, as SubColumns::roofs.
  float roof_slope(double offset_rad) const;

 private:
  struct Strip {
    double from_rad, to_rad;
    double slope;  // the greatest of what its buildings hide
  };
  void cut(int azimuth_bin, int planes);
  void find_spans(const Strip& strip, SinCos bearing);
  void march(Strip& strip, SinCos bearing, const SubColumns& columns, double start_rad, CornerView& corners,
             const EchoCells& cells);
  void take_samples(const EchoCells& cells);
  void add_echoes(int profile, EchoCells& cells);

  const ScenePlan& plan_;
  const NearBuildings& near_;
  const ScatteringTable& scattering_;
  double far_m_;
  SegmentSampler sampler_;
  SampleBatch samples_;
  std::span<const NearBuildings::Seen> buildings_;  // of the bin
  std::vector<Strip> strips_;
  std::vector<double> edges_;
  std::vector<RoofSpan> spans_;
  std::vector<FacePower> echoes_;
};

}  // namespace obliq
