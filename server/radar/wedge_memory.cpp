#include "server/radar/wedge_memory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/beam/echo_layout.h"
#include "server/radar/beam/echo_plan.h"
#include "server/radar/beam/echo_rows.h"
#include "server/radar/render.h"

namespace obliq {
namespace {

/// Accumulators and block (49), its video and the look that it needs (11), and a visible and a present mark
/// of up to 9 profiles and of all together.
constexpr double kBytesABin = 49 + 11 + 2 * 10;
/// A bin, a cell, a kind and a power, for each of the wedge's azimuth bins and for merging one of them, with
/// room to grow into.
constexpr double kBytesAScatterer = 2 * 28;
constexpr double kLeastScatterers = 8192;
/// Of sub-columns: sums, the newest scatterer and a mark of a bin, and what buildings leave of a plane's
/// light.
constexpr double kBytesOfSums = 57;
constexpr double kBytesAShare = 4;
/// Sines of elevation behind a beam: sums by samples and by echoes, and the block's.
constexpr std::int64_t kBytesOfSines = 2 * 8 + 4;
/// A node of a plane's profile. Nodes stand at least so close together, in range bins (BuildingView).
constexpr double kBytesANode = 20;
constexpr double kNodesABin = 16;
/// Rays, hits and samples of one batch, and samples that wait.
constexpr double kBytesOfBatches = 2.5e6;
/// A pixel that waits for its ray; they wait by squares of 8 rows.
constexpr double kBytesAPixel = 48;
constexpr double kRowsOfSquares = 8;

/// Ground cells in an azimuth bin: their side is more than a quarter of the shorter side of a bin at half the
/// range (SpeckleField).
double cells_in_azimuth_bin(const RadarSettings& s) {
  constexpr int kRings = 64;
  const double width_rad = s.sector_deg * std::numbers::pi / 180 / s.azimuth_bins;
  const double spacing_m = (s.r_max_m - s.r_min_m) / s.range_bins;
  double cells = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const double range_m = s.r_min_m + (s.r_max_m - s.r_min_m) * (ring + 0.5) / kRings;
    const double side_m = std::max(std::min(spacing_m, width_rad * range_m / 2) / 4, 1e-3);
    cells += width_rad * range_m * (s.r_max_m - s.r_min_m) / kRings / (side_m * side_m);
  }
  return cells;
}

}  // namespace

std::int64_t wedge_bytes(const RadarSettings& s) {
  const double azimuths = std::min(kWedgeAzimuthBins, s.azimuth_bins);
  const double share = azimuths / s.azimuth_bins;
  const double columns = std::ceil(s.pixel_columns * share);
  const bool sweep = s.frustum == FrustumKind::sweep;
  double bytes = kBytesOfBatches + kBytesABin * azimuths * s.range_bins;
  if (s.speckle != SpeckleKind::geometric) {
    // The sweep cuts each of its planes at range bins and cells; a spread pixel reaches into some bins.
    const double samples =
        columns / azimuths * (sweep ? 4.0 * s.range_bins : 2.0 * s.pixel_rows + s.range_bins);
    const double scatterers = std::max(kLeastScatterers, std::min(samples, cells_in_azimuth_bin(s)));
    bytes += kBytesAScatterer * (azimuths + 1) * scatterers;
  }
  if (sweep) {
    const double spacing_m = (s.r_max_m - s.r_min_m) / s.range_bins;
    const double planes = columns / azimuths;
    if (s.sub_columns > 0)
      bytes += azimuths * s.range_bins * (kBytesOfSums + kBytesAShare * planes) +
               kBytesANode * planes * kNodesABin * s.r_max_m / spacing_m;
    return std::llround(bytes);
  }
  return std::llround(bytes + kBytesAPixel * kRowsOfSquares * s.pixel_columns);
}

RenderingSize rendering_size(const RadarSettings& s, std::int64_t threads) {
  if (!needs_echo_plan(s)) return {threads * wedge_bytes(s), 0};
  const EchoSize size = echo_size(s, threads);
  const std::int64_t kept =
      s.scan_mode == ScanMode::frame ? 0 : std::min(std::int64_t{SharpStore::kMostBytes}, size.sharp_bytes);
  const std::int64_t sines = kBytesOfSines * kWedgeAzimuthBins * size.sharp.range_bins;
  return {threads * (wedge_bytes(size.sharp) + sines + size.sums_bytes) + size.plan_bytes + size.rows_bytes +
              kept,
          size.taps()};
}

}  // namespace obliq
