#pragma once
// Frames of which only some even wedges are rendered: their bins and their time.
#include <complex>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/accuracy/bin_errors.h"
#include "server/radar/frame_plan.h"

namespace obliq {

/// What the comparisons are rendered with, whatever frustum the scene has: the source with the least sampling
/// noise of its own. Its densities, in samples a bin, are beside it.
constexpr FrustumKind kComparisonSource = FrustumKind::polar;
constexpr int kComparisonColumns = 4;  ///< an azimuth bin
constexpr int kComparisonRows = 16;    ///< a range bin

/// Eight wedges of a frame, 64 azimuth bins, spread evenly over it; all when it has no more.
std::vector<AzimuthRange> even_wedges(const RadarSettings& settings);
int azimuth_bins_in(const std::vector<AzimuthRange>& wedges);

/// The bins of some wedges, one after the other: planes [azimuth bins of the wedges][n_range].
struct WedgePlanes {
  std::vector<double> power_w;
  std::vector<std::complex<float>> iq;
  std::vector<std::uint32_t> count;
  double frame_s = 0;  ///< what the whole frame would take on all threads, by the quickest of the repetitions
  FrameStats stats;
};

/// Renders the wedges, as often as told; a wedge each for `threads` threads (0: all cores).
WedgePlanes render_sample(const FramePlan& plan, const std::vector<AzimuthRange>& wedges, int threads,
                          int repetitions, bool states);

/// The scene's settings with the comparison's source, so many columns an azimuth bin and rows a range bin. No
/// range normalisation, so that bins weigh as design section 3 has it.
RadarSettings comparison_settings(RadarSettings settings, int columns, int rows);

RangeBins range_bins_of(const BinGrid& bins);

/// Speckle of a frame: intensity over power in the lit bins.
struct SpeckleMeasure {
  double contrast = 0;        ///< standard deviation over mean of |v|^2 / P
  double median_samples = 0;  ///< in a lit bin that has any
};
SpeckleMeasure measure_speckle(const WedgePlanes& planes);

}  // namespace obliq
