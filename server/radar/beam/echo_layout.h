#pragma once
// How large the sharp frame behind a beam and a pulse is, and the plan of the sums over it: by arithmetic
// alone, before anything is made.
#include <cstdint>
#include <optional>
#include <vector>

#include "server/radar/beam/antenna_axes.h"
#include "server/radar/beam/patterns.h"
#include "server/radar/bins.h"
#include "server/radar/doppler/sea_motion.h"
#include "server/radar/settings.h"
#include "server/radar/simd/receiver/rows.h"
#include "terrain/base/errors.h"

namespace obliq {

/// The beam weighs azimuths. An image of synthetic aperture sees its sector by all of the beam.
inline bool has_beam(const RadarSettings& s) {
  return s.beam.pattern != BeamPattern::off && s.mode != RadarMode::sar;
}

/// Antenna height and range limits for the plan.
struct EchoPlace {
  double height_m = 0;        ///< how far the lowest ground lies below the antenna, or the highest above it
  double least_r_min_m = 0;   ///< what the frustum allows
  AntennaAxes axes = {};      ///< about the sector's centre
  double above_ground_m = 0;  ///< of the antenna; of use where it leans, and to Doppler
  SectorVelocity velocity = {};
  std::vector<int> windy = {};  ///< materials that move in the wind, where that matters
  bool all_windy = false;       ///< all that the scene is made of do
  MovingSea sea = {};           ///< the same of the sea
};

/// The azimuths of ground that an antenna which is not stabilised looks at: its sharp azimuths are scan
/// angles, and what each sees at some elevation lies up to `reach` bins beside it.
struct GroundLayout {
  int reach = 0;
  int azimuths = 0;  ///< in the middle of them the sector's centre
  bool wraps = false;
};

/// Sharp bins around those of the output, in whole wedges and bins.
struct EchoLayout {
  /// Azimuth weights are chosen for tiles of so many sharp range bins.
  static constexpr int kTile = 16;

  int azimuth_parts = 1;  ///< sharp bins an output bin, each way
  int wanted_parts = 1;   ///< those that Doppler would take, where more than can be made
  int range_parts = 1;
  double azimuth_rad = 0;  ///< width of a sharp azimuth
  double turn_rad = 0;     ///< how far the antenna turns while it looks along one output bin
  double range_m = 0;      ///< length of a sharp range bin
  double r_min_m = 0;      ///< of the sharp frame
  int near = 0;            ///< sharp range bins nearer than output bin 0
  int far = 0;             ///< and beyond the last
  int gate_reach = 0;      ///< sharp range bins on either side that a pulse may weigh
  int reach = 0;           ///< sharp azimuths on either side that a beam may weigh
  int n_kernels = 1;       ///< sets of azimuth weights, by cosine_steps
  bool wraps = false;      ///< the sharp frame goes all the way round
  bool closes = true;      ///< its bins meet there; else no such frame can be made
  int sharp_azimuths = 0;
  int sharp_ranges = 0;
  int first_azimuth = 0;  ///< sharp azimuth at the left edge of output bin 0
  GroundLayout ground;    ///< azimuths 0: that of the sharp bins

  int n_taps() const { return 2 * reach + azimuth_parts; }
  /// A set of azimuth weights with zeros on either side, for neighbouring outputs.
  int kernel_length() const { return n_taps() + 2 * kernel_pad(); }
  int kernel_pad() const { return (kWedgeAzimuthBins - 1) * azimuth_parts; }
  int n_gates() const { return 2 * gate_reach + range_parts; }
  int n_tiles() const { return (sharp_ranges + kTile - 1) / kTile; }
  /// Sharp range bins of a row with what is behind them.
  std::int64_t stride() const { return std::int64_t{n_tiles()} * kTile; }
};

/// Of settings that need a plan (needs_echo_plan).
EchoLayout lay_out_echo(const RadarSettings& settings, const AzimuthPattern& pattern, const EchoPlace& place);

/// The settings of the sharp frame.
RadarSettings sharp_frame(const RadarSettings& settings, const EchoLayout& layout);
/// Of what is looked at for it: the sharp frame, or the ground's azimuths.
RadarSettings ground_frame(const RadarSettings& settings, const EchoLayout& layout);

/// The cosine step of the steepest ground that there may be at a range from the antenna and beyond.
int steepest_step(const EchoPlace& place, double range_m);
/// Its cosine of elevation.
double least_cosine(const EchoPlace& place, double range_m);

/// Rows of a train of pulses that are added up in one pass.
constexpr int kPulseRows = 256;

/// What a plan and the sums over it take at most, wherever the antenna is.
struct EchoSize {
  RadarSettings sharp;           ///< of the largest sharp frame
  std::int64_t n_taps = 0;       ///< azimuth weights at an elevation
  std::int64_t n_kernels = 0;    ///< elevations
  std::int64_t n_tiles = 0;      ///< of ranges
  std::int64_t plan_bytes = 0;   ///< the plan, made once
  std::int64_t sums_bytes = 0;   ///< EchoSums, each thread's
  std::int64_t rows_bytes = 0;   ///< sharp wedges that wait for others, and lists of them
  std::int64_t sharp_bytes = 0;  ///< all sharp wedges

  std::int64_t taps() const { return n_taps * n_tiles; }
};
/// label_materials: as wedge_bytes().
EchoSize echo_size(const RadarSettings& settings, std::int64_t threads, int label_materials = 0);

/// Why no sharp frame can be laid out so: its bins do not meet, it has more pixels than can be numbered, or
/// it is to be an image of an antenna that does not fly.
std::optional<FieldError> layout_fault(const RadarSettings& settings, const EchoLayout& layout,
                                       const EchoPlace& place);

/// The same as far as the settings say so themselves; nothing: the antenna's height above the ground decides,
/// or its velocity.
std::optional<std::vector<FieldError>> layout_faults(const RadarSettings& settings,
                                                     const AntennaAxes& axes = {});

}  // namespace obliq
