#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/explain/measurement.h"
#include "server/radar/geometry/pose.h"
#include "server/radar/receiver/weather.h"
#include "server/scene/scene.h"

namespace obliq {

/// The bins as the radar itself has them, and without one of its parts.
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

/// What one part of the radar does in this scene's bins, by closed forms and the bins' measured power.
struct RadarRow {
  std::string name;  ///< "noise"
  std::string text;
};

/// Beam, elevation, pulse, noise, STC, rain, gas and video.
std::vector<RadarRow> radar_rows(const RadarSettings& settings, const AirView& air,
                                 const RadarPowers& powers);

/// Signal-to-noise ratio of one pulse, in dB, at which a steady target is found with probability 0.9 at a
/// false alarm probability of 1e-6 when so many looks are integrated: Albersheim's equation (Proc. IEEE 69,
/// 1981; to 0.2 dB).
double detectable_snr_db(int looks);

}  // namespace obliq
