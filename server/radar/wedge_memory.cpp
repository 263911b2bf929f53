#include "server/radar/wedge_memory.h"

#include <algorithm>

#include "server/radar/beam/echo_layout.h"
#include "server/radar/beam/echo_plan.h"
#include "server/radar/beam/echo_rows.h"
#include "server/radar/echo/echo_bins.h"
#include "server/radar/echo/echo_cells.h"
#include "server/radar/narrow_bins.h"
#include "server/radar/rays/perspective_rays.h"
#include "server/radar/render.h"
#include "server/radar/sea_state.h"
#include "server/radar/sweep/sweep_echoes.h"
#include "server/radar/visibility/wedge_visibility.h"

namespace obliq {
namespace {

/// Rays, hits and samples of one batch, and samples that wait.
constexpr std::int64_t kBytesOfBatches = 2'500'000;

}  // namespace

bool may_need_materials(const RadarSettings& s) { return uses_doppler(s) && sea_state(s) > 0; }

std::int64_t wedge_bytes(const RadarSettings& s, int label_materials) {
  const std::int64_t of_labels =
      label_materials == 0 ? 0 : BinBlock::kLabelBytesABin + LabelShare::bytes_a_bin(label_materials);
  const std::int64_t bins =
      (BinBlock::kBytesABin + of_labels) * s.range_bins * std::min(kWedgeAzimuthBins, s.azimuth_bins);
  if (narrow_bins(s) > 1) return wedge_bytes(narrow_frame(s), label_materials) + bins;
  const std::int64_t bytes = kBytesOfBatches + bins + LabelSums::bytes(s.range_bins, label_materials) +
                             WedgeVisibility::bytes(s.range_bins) + EchoBins::bytes(s);
  if (s.frustum != FrustumKind::sweep) return bytes + PerspectiveRays::bytes(s);
  return s.sub_columns == 0 ? bytes : bytes + EchoCells::bytes(s.range_bins) + SweepEchoes::bytes(s);
}

RenderingSize rendering_size(const RadarSettings& s, std::int64_t threads, int label_materials) {
  // No more threads than wedges have something to do.
  const auto at_work = [threads](const RadarSettings& looked_at) {
    return std::min(threads, std::int64_t{wedge_count(looked_at.azimuth_bins)});
  };
  if (!needs_echo_plan(s)) return {at_work(s) * wedge_bytes(s, label_materials), 0};
  const EchoSize size = echo_size(s, threads, label_materials);
  const std::int64_t kept =
      s.scan_mode == ScanMode::frame ? 0 : std::min(std::int64_t{SharpStore::kMostBytes}, size.sharp_bytes);
  return {at_work(size.sharp) * (wedge_bytes(size.sharp, label_materials) + size.sums_bytes) +
              size.plan_bytes + size.rows_bytes + kept,
          size.taps()};
}

}  // namespace obliq
