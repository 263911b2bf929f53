#pragma once
#include <memory>
#include <vector>

namespace obliq {

struct PatternCuts;  // server/radar/beam/pattern_cuts.h

/// One-way power pattern of the antenna in azimuth, and in elevation (server/radar/beam/patterns.h).
enum class BeamPattern { off, gaussian, uniform, cosine, taylor, file };
enum class ElevationPattern { off, gaussian, cosecant, file };

/// [beam].
struct BeamSettings {
  BeamPattern pattern = BeamPattern::off;
  double width_deg = 3;  ///< one-way, half power
  double sidelobe_db = 30;
  int nbar = 4;
  double extent_deg = 0;  ///< beyond it the azimuth pattern is 0; 0: chosen by the pattern
  ElevationPattern elevation = ElevationPattern::off;
  double elevation_width_deg = 6;
  double cosecant_to_deg = 30;  ///< depression to which the cosecant reaches
  /// Held level, whatever its platform does; else its beam rolls and pitches with it (antenna_axes.h).
  bool stabilised = true;
  std::shared_ptr<const PatternCuts> file;  ///< of the patterns "file"; else null
};

/// What a point becomes in range (server/radar/beam/point_response.h).
enum class PulseKind { off, rectangular, compressed };
enum class PulseWindow { none, hamming, hann, taylor };

/// [pulse].
struct PulseSettings {
  PulseKind kind = PulseKind::off;
  double length_us = 1;
  double bandwidth_mhz = 0;  ///< of a compressed pulse; 0: that which a range bin resolves
  PulseWindow window = PulseWindow::hamming;
  double sidelobe_db = 30;
  int nbar = 4;
  int extent_bins = 16;  ///< half the length of the range filter
  bool eclipse = false;
  double prf_hz = 1000;  ///< of the modes that look at Doppler
  /// Of pulse trains: intervals between pulses over 1 / prf_hz, one after the other, round and round; empty:
  /// all alike.
  std::vector<double> stagger;
};

}  // namespace obliq
