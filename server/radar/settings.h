#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/radar/receiver_settings.h"
#include "terrain/base/errors.h"

namespace obliq {

enum class FrustumKind { symmetric, oblique, polar, sweep };
/// How a hit is given to range bins: spread over all that its pixel covers, or whole to the bin of its own
/// range, as the paper does it.
enum class PlateKind { spread, nearest };
enum class SpeckleKind { ground, geometric };
/// How a live radar's antenna sweeps its sector: all of it at once in each frame, to and fro, or round and
/// round.
enum class ScanMode { frame, sector, circular };
/// One-way power pattern of the antenna in azimuth, and in elevation (server/radar/beam/patterns.h).
enum class BeamPattern { off, gaussian, uniform, cosine, taylor, file };
enum class ElevationPattern { off, gaussian, cosecant, file };
/// What a point becomes in range (server/radar/beam/point_response.h).
enum class PulseKind { off, rectangular, compressed };
enum class PulseWindow { none, hamming, hann, taylor };
enum class HeightReference { datum, ground, ellipsoid };

/// As in a scene file: "symmetric", "oblique", "polar", "sweep"; "nearest", "spread".
std::string frustum_name(FrustumKind kind);
std::string plates_name(PlateKind plates);

struct PatternCuts;  // server/radar/beam/pattern_cuts.h

/// Everything a client may choose about a radar, in the operator's units (server/control/parameters.h has
/// the table of names, defaults and limits). Ranges are slant ranges.
struct RadarSettings {
  double frequency_ghz = 10;
  double sector_deg = 120;
  double r_min_m = 3700;
  double r_max_m = 37000;
  double power_w = 1;
  double gain_db = 0;
  bool range_normalisation = false;
  SpeckleKind speckle = SpeckleKind::ground;
  std::int64_t speckle_seed = 1;
  FrustumKind frustum = FrustumKind::oblique;
  PlateKind plates = PlateKind::spread;
  int pixel_columns = 2048;  ///< of the sweep: vertical planes in the sector, at least
  int pixel_rows = 2048;     ///< the sweep has none
  /// Of the sweep: lanes that see the buildings of an azimuth bin; 0: exact vertical planes at each of them.
  int sub_columns = 64;
  int azimuth_bins = 1024;
  int range_bins = 1024;
  ScanMode scan_mode = ScanMode::frame;
  double scan_rate_deg_s = 36;  ///< 6 turns a minute
  int scan_dwell_bins = 8;      ///< azimuth bins that share a pose: a multiple of kWedgeAzimuthBins
  ReceiverSettings receiver = {};
  VideoSettings video = {};
  AtmosphereSettings atmosphere = {};

  BeamPattern beam_pattern = BeamPattern::off;
  double beam_width_deg = 3;  ///< one-way, half power
  double beam_sidelobe_db = 30;
  int beam_nbar = 4;
  double beam_extent_deg = 0;  ///< beyond it the azimuth pattern is 0; 0: chosen by the pattern
  ElevationPattern beam_elevation = ElevationPattern::off;
  double beam_elevation_width_deg = 6;
  double beam_cosecant_to_deg = 30;              ///< depression to which the cosecant reaches
  std::shared_ptr<const PatternCuts> beam_file;  ///< of the patterns "file"; else null

  PulseKind pulse_kind = PulseKind::off;
  double pulse_length_us = 1;
  double pulse_bandwidth_mhz = 0;  ///< of a compressed pulse; 0: that which a range bin resolves
  PulseWindow pulse_window = PulseWindow::hamming;
  double pulse_sidelobe_db = 30;
  int pulse_nbar = 4;
  int pulse_extent_bins = 16;  ///< half the length of the range filter
  bool pulse_eclipse = false;
};

/// Something is done to the bins after the echoes: by the receiver itself, or as rain's own echo.
bool has_receiver(const RadarSettings& settings);

/// Samples are multiplied by range squared as they are binned. What comes after the bins needs them as they
/// are: then range normalisation is the receiver's last step.
bool normalises_samples(const RadarSettings& settings);

/// Where the antenna is and where its sector's centre points, in the operator's units.
struct PoseSettings {
  double latitude_deg = 0;
  double longitude_deg = 0;
  double height_m = 1000;
  HeightReference height_reference = HeightReference::datum;
  double geoid_undulation_m = 0;  ///< used with HeightReference::ellipsoid only
  double bearing_deg = 0;         ///< centre of the sector, clockwise from the antenna's true north
  std::int64_t sim_time_ns = 0;   ///< in the controller's clock (server/flight/pose_time_line.h)
  std::uint64_t pose_id = 0;
  double valid_s = 0;  ///< stale so long after its arrival; 0: never

  bool operator==(const PoseSettings&) const = default;
};

/// The same place, height and bearing, whenever and however long it is valid.
bool same_antenna(PoseSettings a, const PoseSettings& b);

/// A validated, published set of settings. Never changes; a change is a new snapshot with a new version.
struct SettingsSnapshot {
  RadarSettings settings;
  std::uint64_t version = 0;
};
using SettingsPtr = std::shared_ptr<const SettingsSnapshot>;

}  // namespace obliq
