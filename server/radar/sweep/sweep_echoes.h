#pragma once
#include <vector>

#include "server/radar/echo/echo_cells.h"
#include "server/radar/sweep/building_view.h"

namespace obliq {

/// Which azimuth bins have sub-columns. Those do not whose buildings stand very near to the antenna, and none
/// do that are very wide or have materials whose power is not proportional to area; frustum.sub_columns = 0
/// wants none.
class SubColumnBins {
 public:
  explicit SubColumnBins(const FramePlan& plan);
  bool all_of(AzimuthRange range) const;

 private:
  std::vector<bool> suffices_;  // [n_azimuth]
};

/// The sweep, without samples in between: first the buildings of each azimuth bin by sub-columns, then bare
/// ground along the bins' planes, those that stand at the same place in their bins side by side.
class SweepEchoes {
 public:
  SweepEchoes(const FramePlan& plan, AzimuthRange range, EchoCells& cells);

  /// Goes on for as long as a batch of samples would take; false when nothing is left.
  bool step(FrameStats& stats);

 private:
  bool step_buildings();
  void start_planes();
  void step_ground();

  const FramePlan& plan_;
  AzimuthRange range_;
  EchoCells& cells_;
  int planes_;  // a bin; none where no ground is known
  BuildingView view_;
  int viewed_ = 0;  // azimuth bins whose buildings are done
  bool viewing_ = false;
  std::vector<float> kept_;  // [planes][n_range][8]; empty: all of it
  int plane_ = 0;
  bool marching_ = false;
  GroundCut cut_;
  GroundView ground_;
  SightProfiles profiles_;
  VisibleSegments segments_;
  GroundEchoes echoes_;
};

}  // namespace obliq
