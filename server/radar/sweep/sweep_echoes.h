#pragma once
#include <limits>
#include <memory>
#include <vector>

#include "server/radar/echo/echo_cells.h"
#include "server/radar/sweep/building_view.h"
#include "server/radar/sweep/swept_returns.h"

namespace obliq {

/// Whether a frame is swept by echoes (SweepEchoes). Not by rays; nor with very short or very long range
/// bins, nor where frustum.sub_columns = 0 wants exact planes.
bool has_sub_columns(const ScenePlan& plan);

/// The sweep, without samples in between: first the buildings of each azimuth bin by sub-columns, then bare
/// ground along the bins' planes, those that stand at the same place in their bins side by side.
class SweepEchoes {
 public:
  /// Nothing that lies beyond far_m need be seen.
  SweepEchoes(const ScenePlan& plan, AzimuthRange range, const NearBuildings& near,
              const ScatteringTable& scattering, EchoCells& cells,
              double far_m = std::numeric_limits<double>::infinity());

  void run(FrameStats& stats);
  /// Of labels: their returns, after run().
  void write_returns(BinBlock& block) const {
    if (returns_) returns_->write(block);
  }

  /// Of each plane a float a bin, and the nodes of the view of buildings.
  static std::int64_t bytes(const RadarSettings& settings);

 private:
  void view_buildings();
  void march_planes();
  void start_planes();
  void start_plane(int half);
  void end_run(std::size_t run);
  void end_stretch(std::size_t run);
  void take_stretches();

  const ScenePlan& plan_;
  AzimuthRange range_;
  double far_m_;
  EchoCells& cells_;
  int planes_;  // a bin; none where no ground is known
  BuildingView view_;
  std::vector<float> kept_;  // [planes][n_range][8]; empty: all of it
  int plane_ = 0;
  GroundCut cut_;
  GroundView ground_;
  // Two planes of each azimuth bin side by side, where it has two.
  int together_ = 1;
  double plane_width_rad_ = 0;
  bool half_marching_[2];
  SightProfiles profiles_[2];
  VisibleSegments segments_[2];
  GroundEchoes echoes_;
  // Of labels; null: none are wanted.
  std::unique_ptr<GroundStretches> stretches_;
  std::unique_ptr<SweptReturns> returns_;
};

}  // namespace obliq
