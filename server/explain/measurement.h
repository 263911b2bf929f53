#pragma once
// Frames of which only some even wedges are rendered: their bins and their time; how bins and ground of a
// changed world differ.
#include <complex>
#include <cstdint>
#include <vector>

#include "server/accuracy/bin_errors.h"
#include "server/accuracy/truth_bins.h"
#include "server/radar/frame_plan.h"
#include "terrain/world.h"

namespace obliq {

/// Where samples come from.
struct SampleKind {
  FrustumKind frustum;
  PlateKind plates;
};

/// What the comparisons are rendered with: the sweep, the source with the least sampling noise of its own,
/// or, where flat plates ask for them, the radar's own rays.
SampleKind comparison_source(const RadarSettings& settings, const std::vector<Material>& materials);
/// The radar's own rays, or those of the oblique frustum for a sweep: what only rays can do.
SampleKind ray_source(const RadarSettings& settings, PlateKind plates);

/// How densely a source samples the bins.
struct Density {
  int columns = 0;  ///< an azimuth bin, or a stretch of it (see columns_factor)
  double rows = 0;  ///< a range bin; the sweep has none
};
constexpr Density kComparisonDensity{8, 16};
/// About as dense: what differs from them is sampling noise. No whole numbers of rows, since a change of the
/// scene shifts the rows against the range bins too.
constexpr Density kOtherDensities[] = {{9, 15.43}, {7, 17.21}};

/// Wide azimuth bins take more columns, up to eight times as many: so that they are half a cell apart at
/// r_max.
int columns_factor(const RadarSettings& settings, double cell_m);

/// So many azimuth bins are measured, in even wedges; all where there are no more.
constexpr int kMeasuredAzimuths = 64;

/// The bins of some wedges, one after the other: planes [azimuth bins of the wedges][n_range].
struct WedgePlanes {
  std::vector<double> power_w;
  std::vector<std::complex<float>> iq;
  std::vector<std::uint32_t> count;
  /// The wedges' processor time scaled to all bins and threads, of the quickest repetition.
  double frame_s = 0;
  double spread_s = 0;  ///< how much longer the slowest took
  FrameStats stats;
};

/// Renders the runs, as often as told; one each for `threads` threads (0: all cores).
WedgePlanes render_sample(const FramePlan& plan, const AzimuthRuns& runs, int threads, int repetitions,
                          bool states);

/// The scene's settings with another source, of 1 W and 0 dB. No range normalisation, so that bins weigh as
/// PAPER.md, definitions, has it.
RadarSettings comparison_settings(RadarSettings settings, SampleKind source, Density density);

/// The middle one of values in any order, the upper of two; 0 without any.
double upper_median(std::vector<double>& values);

/// Speckle of a frame: intensity over power in the lit bins.
struct SpeckleMeasure {
  double contrast = 0;        ///< standard deviation over mean of |v|^2 / P
  double median_samples = 0;  ///< in a lit bin that has any
};
SpeckleMeasure measure_speckle(const WedgePlanes& planes);

/// How the power in the bins differs when the model is changed. Lit bins are those of PAPER.md, with
/// the unchanged planes in the truth's place.
struct PowerChange {
  std::uint64_t lit = 0;  ///< lit bins of the unchanged scene
  double median_db = 0;   ///< of |10 log10 P'/P| over lit bins with P' > 0
  double percentile95_db = 0;
  double over_1_db = 0;  ///< share of the lit bins whose power changes by more than 1 dB, to nothing included
  double vanished = 0;   ///< lit bins that go dark (P' = 0), as a share of the lit ones
  double appeared = 0;   ///< dark bins that become lit ones, as a share of the lit ones
  double total_ratio = 1;  ///< total P' over total P

  /// Of all power nothing is left, and no decibels say so.
  bool nothing_left() const { return !(total_ratio > 0); }
  /// 10 log10 of the total's ratio; -infinity when nothing is left.
  double total_db() const;
};

/// The larger of each measure.
PowerChange larger_of(const PowerChange& a, const PowerChange& b);

/// Compares two planes [n_azimuth][n_range] of the same bins.
PowerChange power_change(const std::vector<double>& power_w, const std::vector<double>& changed_w,
                         const RangeBins& ranges);

/// Material ids that ground or buildings of a world have, 0 (the terrain's) left out, rising.
std::vector<std::uint8_t> materials_used(const World& world);

/// Middle sizes of a world's buildings, metres: roofs above the ground, roots of the outlines' areas. 0
/// without any.
struct BuildingSizes {
  double height_m = 0;
  double side_m = 0;
};
BuildingSizes median_sizes(const Buildings& buildings);

/// How far a change of the model moves the ground, as the antenna sees it. Metres.
struct GroundShift {
  double slant_m = 0;     ///< greatest change of a ground point's slant range
  double vertical_m = 0;  ///< greatest change of its height below the antenna
};

/// Points of the ground in sector and swath that are looked up again in a changed world. Positions (x, z) are
/// the same in every earth of one origin.
class GroundProbes {
 public:
  GroundProbes(const FramePlan& plan, const AzimuthRuns& runs);

  /// Where both worlds know the ground.
  GroundShift shift_in(const World& world, const Pose& pose) const;

  std::size_t size() const { return points_.size(); }

 private:
  struct Point {
    double x_m, z_m, below_antenna_m, slant_m;
  };
  std::vector<Point> points_;
};

}  // namespace obliq
