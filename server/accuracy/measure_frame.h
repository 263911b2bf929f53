#pragma once
// What a frame costs and how wrong it is, from the same frame.
#include <memory>

#include "server/accuracy/bin_errors.h"
#include "server/accuracy/truth_bins.h"
#include "server/radar/frame_plan.h"

namespace obliq {

/// Least and median time of a number of whole frames, seconds.
struct FrameTime {
  double least_s = 0;
  double median_s = 0;
  double processor_s =
      0;  ///< least, of all threads together: hardly grows when the machine is busy otherwise
};

struct ReturnErrors {
  BinErrors bins;
  BuildingErrors buildings;  ///< nothing for Returns::terrain
};

/// A planned view: the scene, how it is sampled, and from where.
struct View {
  std::shared_ptr<const Scene> scene;
  SettingsPtr settings;
  Pose pose;
};

struct MeasureOptions {
  int threads = 0;
  int repeats = 3;  ///< timed frames, after one that is not
};

struct FrameMeasurement {
  FrameTime all_planes;  ///< plan, render, every plane: what a client waits for
  FrameTime no_states;   ///< the same without the state plane, which few samplings need and all can drop
  FrameStats stats;
  bool has_buildings = false;  ///< else the errors of all returns are those of the terrain
  ReturnErrors errors[3];      ///< by Returns
};

/// Throws InputError when the frame cannot be planned. match: match_buildings() from the truth's world to the
/// view's; the truth may come from a finer grid.
FrameMeasurement measure_frame(const View& view, const TruthBins& truth,
                               const std::vector<std::uint32_t>& match, const MeasureOptions& options);

/// What stands for the truth where that would take hours: the power of a frame of many planes. It sees the
/// buildings that it has a sample of.
TruthBins render_truth(const View& view, const AzimuthRuns& runs, int threads);

/// The errors alone, from rendering no more than the truth's azimuths.
FrameMeasurement measure_errors(const View& view, const TruthBins& truth,
                                const std::vector<std::uint32_t>& match, int threads);

}  // namespace obliq
