#pragma once
#include <vector>

#include "server/radar/echo/echo_cells.h"
#include "server/radar/sweep/building_view.h"

namespace obliq {

/// Whether the sub-columns of azimuth bins see their buildings well enough. They do not very near to the
/// antenna, in very wide bins, and where power is not proportional to area; frustum.sub_columns = 0 wants
/// none.
bool sub_columns_suffice(const FramePlan& plan, AzimuthRange range);

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
