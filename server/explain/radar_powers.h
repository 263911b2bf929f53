#pragma once
// The bins as the radar itself has them, and without one of its parts.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/explain/measurement.h"
#include "server/radar/geometry/pose.h"
#include "server/scene/scene.h"

namespace obliq {

struct RadarPowers {
  std::vector<double> own_w;  ///< [azimuth][range_bins], without receiver and weather
  /// What would change; nothing where the radar has no such part.
  std::optional<PowerChange> without_beam;
  std::optional<PowerChange> without_elevation;
  std::optional<PowerChange> without_pulse;
};

struct RadarView {
  std::shared_ptr<const Scene> scene;
  const Pose& pose;
  const std::string& radar;
  const std::vector<AzimuthRange>& wedges;
  int threads;
};

/// Throws InputError when the radar cannot be planned.
RadarPowers measure_radar_powers(const RadarView& view, RadarSettings settings);

}  // namespace obliq
