#pragma once
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "server/radar/beam_settings.h"
#include "server/radar/doppler_settings.h"
#include "server/radar/receiver_settings.h"
#include "server/scene/materials.h"
#include "terrain/base/errors.h"

namespace obliq {

/// polar makes no frames any more: recordings of 1.0 and 1.1 have it, and its number stays.
enum class FrustumKind { symmetric, oblique, polar, sweep };
/// How a hit is given to range bins: spread over all that its pixel covers, or whole to the bin of its own
/// range, as the paper does it.
enum class PlateKind { spread, nearest };
/// What makes bins glitter. ground: scatterers fixed to the ground; geometric: the paper's, from the ranges
/// of samples; none: the root of the mean power; independent: each azimuth bin another draw, as of a radar
/// that turns or changes frequency; automatic: independent where an antenna with a beam scans, else ground.
enum class SpeckleKind { ground, geometric, none, independent, automatic };
/// How a live radar's antenna sweeps its sector: all of it at once in each frame, to and fro, or round and
/// round.
enum class ScanMode { frame, sector, circular };
enum class HeightReference { datum, ground, ellipsoid };

/// As in a scene file: "symmetric", "oblique", "polar", "sweep"; "nearest", "spread".
std::string frustum_name(FrustumKind kind);
std::string plates_name(PlateKind plates);

/// Everything a client may choose about a radar, in the operator's units (server/control/parameters.h has
/// the table of names, defaults and limits). Ranges are slant ranges.
struct RadarSettings {
  double frequency_ghz = 10;
  RadarMode mode = RadarMode::map;
  double sector_deg = 120;
  double r_min_m = 3700;
  double r_max_m = 37000;
  double power_w = 1;
  double gain_db = 0;
  bool range_normalisation = false;
  SpeckleKind speckle = SpeckleKind::automatic;
  std::int64_t speckle_seed = 1;
  FrustumKind frustum = FrustumKind::oblique;
  PlateKind plates = PlateKind::spread;
  int pixel_columns = 2048;  ///< of the sweep: vertical planes in the sector, at least
  int pixel_rows = 2048;     ///< the sweep has none
  /// Of the sweep, above 0: pixel_columns follow the azimuth bins (server/control/planes_per_bin.h).
  int planes_per_bin = 0;
  /// Of the sweep: lanes that see the buildings of an azimuth bin; 0: exact vertical planes at each of them.
  int sub_columns = 64;
  int azimuth_bins = 1024;
  int range_bins = 1024;
  ScanMode scan_mode = ScanMode::frame;
  double scan_rate_deg_s = 36;  ///< 6 turns a minute
  int scan_dwell_bins = 8;      ///< azimuth bins that share a pose: a multiple of kWedgeAzimuthBins
  /// Elevations of the boresight, one a pass of a scan, in turn; empty: the pose's.
  std::vector<double> scan_bars_deg;
  BeamSettings beam;
  PulseSettings pulse;
  DopplerSettings doppler;
  ReceiverSettings receiver;
  VideoSettings video;
  AtmosphereSettings atmosphere;
  SeaSettings sea;

  double azimuth_bin_rad() const { return sector_deg * std::numbers::pi / 180 / azimuth_bins; }
  double range_bin_m() const { return (r_max_m - r_min_m) / range_bins; }
};

/// The kind that `automatic` stands for; others are themselves.
SpeckleKind resolved_speckle(const RadarSettings& settings);

/// Why no frame can be sampled like this, whatever the scene: a frustum that only recordings have, or the
/// paper's speckle without rays.
std::vector<FieldError> sampling_faults(const RadarSettings& settings);
/// Names of the materials in use that are flat plates.
std::vector<std::string> flat_plates(const std::vector<Material>& materials);
/// Why none can in a scene of these materials: the sweep knows no flat plates.
std::vector<FieldError> flat_plate_faults(const RadarSettings& settings,
                                          const std::vector<Material>& materials);

/// Columns that the sweep cuts an azimuth bin into.
inline int sweep_columns_per_bin(const RadarSettings& s) {
  return (s.pixel_columns + s.azimuth_bins - 1) / s.azimuth_bins;
}

/// Bins are sums over neighbouring sharp ones: of azimuths, of ranges.
inline bool blurs(const RadarSettings& s) {
  return s.beam.pattern != BeamPattern::off || s.pulse.kind != PulseKind::off;
}

/// Something is made of the bins' Doppler.
inline bool uses_doppler(const RadarSettings& s) { return s.mode != RadarMode::map; }

/// The bins are behind a filter over pulses. Those of a radar that gives out its pulses are a map's.
inline bool has_doppler_filter(const RadarSettings& s) {
  return uses_doppler(s) && s.mode != RadarMode::pulses;
}

/// Samples of the trains of one frame or pass; 0 of a radar that does not give out its pulses.
std::int64_t pulse_samples(const RadarSettings& settings);

/// The same radar as a map maker has it: bins as sharp as their edges, no pattern in elevation, speckle of
/// scatterers. What sampling is judged by.
RadarSettings sharp_settings(RadarSettings settings);

/// I&Q follow from the mean powers of bins, and not from scatterers.
inline bool draws_speckle(const RadarSettings& s) {
  const SpeckleKind kind = resolved_speckle(s);
  return kind == SpeckleKind::none || kind == SpeckleKind::independent;
}

/// Something is done to the bins after the echoes: by the receiver itself, or as rain's own echo.
bool has_receiver(const RadarSettings& settings);

/// Samples are multiplied by range squared as they are binned. What comes after the bins needs them as they
/// are: then range normalisation is the receiver's last step.
bool normalises_samples(const RadarSettings& settings);

/// Of each part of a velocity: what is faster is no flight. The escape velocity is 11.2 km/s.
constexpr double kMostSpeed_m_s = 20e3;

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
  double valid_s = 0;      ///< stale so long after its arrival; 0: never
  double tilt_deg = 0;     ///< elevation of the boresight, about the antenna's own vertical, up positive
  bool tilt_auto = false;  ///< instead: towards level ground in the middle of the swath
  double heading_deg = 0;  ///< of the platform; the sector's centre is held against it
  double time_rate = 1;    ///< seconds of the controller's clock in a second
  /// Of the antenna over the ground, along its own north, east and up. Empty: not given. has_velocity() is of
  /// all three; where one is given, those that are not are 0.
  std::optional<double> velocity_north_m_s;
  std::optional<double> velocity_east_m_s;
  std::optional<double> velocity_up_m_s;
  double roll_deg = 0;   ///< of the platform, right side down positive
  double pitch_deg = 0;  ///< of the platform, nose up positive

  bool has_velocity() const { return velocity_north_m_s || velocity_east_m_s || velocity_up_m_s; }
  void clear_velocity() { velocity_north_m_s = velocity_east_m_s = velocity_up_m_s = std::nullopt; }

  bool operator==(const PoseSettings&) const = default;
};

/// The same place, height and bearing, of an antenna that is not stabilised the same attitude, and in modes
/// that look at Doppler the same velocity: whenever, and however long it is valid.
bool same_antenna(const RadarSettings& settings, PoseSettings a, const PoseSettings& b);

/// A validated, published set of settings. Never changes; a change is a new snapshot with a new version.
struct SettingsSnapshot {
  RadarSettings settings;
  std::uint64_t version = 0;
};
using SettingsPtr = std::shared_ptr<const SettingsSnapshot>;

}  // namespace obliq
