#pragma once
// `obliq render --profile`: where the time of loading and of a frame goes.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/radar/geometry/pose.h"
#include "server/radar/settings.h"
#include "server/scene/scene.h"
#include "terrain/base/stage_clock.h"

namespace obliq {

/// Parts of a whole, in seconds. They add up to it.
struct TimeParts {
  std::vector<std::pair<std::string, double>> part_s;
  double whole_s = 0;

  void add(const std::string& name, double seconds) { part_s.emplace_back(name, seconds); }
};

struct Timing {
  TimeParts scene;  ///< wall time: the stages follow one another
  /// Thread time. The whole is threads x wall time; what no stage of any thread has is "idle": serial stages,
  /// the end of the frame, threads that begin late.
  TimeParts frame;
  double frame_s = 0;  ///< wall time, plan to last byte at the reader
  int threads = 0;
  double processor_s = 0;  ///< of the stages' thread time, how much had a processor
  int pairs = 0;           ///< of frames with and without probes, in turns; the frame is the median one with
  /// Frames with probes against those without, the median of the pairs' ratios.
  double wall_ratio = 1;
  double processor_ratio = 1;  ///< of the whole process, the reader included
};

/// The stages that took any time, in order.
TimeParts time_parts(const StageTimes& times);

/// Tables with bars, some 80 characters wide.
std::string timing_text(const Timing& timing);
/// The same as a JSON object.
std::string timing_json(const Timing& timing);

/// What a frame is of.
struct TimedFrame {
  std::shared_ptr<const Scene> scene;
  SettingsPtr settings;
  Pose pose;
  std::string radar;
  std::string scene_name;
  int threads = 0;
};

/// Frames as the daemon makes them, planned, rendered, encoded with all planes and sent over the loopback,
/// with and without probes in turns for a few seconds. All of the timing but the scene's part.
Timing time_frames(const TimedFrame& frame);

}  // namespace obliq
