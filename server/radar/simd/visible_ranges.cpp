// RangeMarch over bare ground for eight profiles at a time.
#include "server/radar/simd/visible_ranges.h"

#include "server/radar/simd/grid_walk.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// Marks the bins of the lanes' runs and empties them.
OBLIQ_INLINE void close(RangeRun<f64x8>& run, mask8 where, const RangeAxis& bins,
                        std::uint8_t* const* marks) {
  where &= run.greatest2 >= 0.0;
  const unsigned mask = movemask(where);
  if (mask == 0) return;
  const f64x8 low = sqrt(run.least2);
  const f64x8 high = sqrt(run.greatest2);
  for (int lane = 0; lane < kLanes; ++lane)
    if ((mask >> lane & 1) != 0) mark_bins(bins, low[lane], high[lane], marks[lane]);
  run.clear(where);
}

/// Member `part` of the lanes' states.
#define OBLIQ_LOAD(part)                     \
  lane_by_lane<double, kLanes>([&](int lane) \
                                   __attribute__((always_inline)) { return lanes.state[lane].part; })

}  // namespace

unsigned mark_visible_ranges(const GroundView& scene, const RangeAxis& bins, RangeProfiles& lanes) {
  const ProfileRates<f64x8> p = rates_of(scene, lanes);
  const f64x8 end_m = load(lanes.end_m);
  const f64x8 roof_m = load(lanes.roof_m);
  Cells<f64x8> cells = cells_of(lanes);
  ProfileState<f64x8> state{{OBLIQ_LOAD(horizon.d_m), OBLIQ_LOAD(horizon.h_m), mask8{}},
                            {OBLIQ_LOAD(visible.least2), OBLIQ_LOAD(visible.greatest2)},
                            {OBLIQ_LOAD(present.least2), OBLIQ_LOAD(present.greatest2)},
                            OBLIQ_LOAD(last_h_m),
                            OBLIQ_LOAD(joined ? 1.0 : 0.0) != 0.0};
  unsigned at_roof = 0;
  const auto next = [&](mask8 active, const CellEnds<f64x8>& ends, f64x8& to) __attribute__((always_inline)) {
    at_roof = movemask(active & (roof_m <= max(cells.d, min(ends.nearest, to))));
    return at_roof != 0 ? mask8{} : active;
  };
  const auto cell = [&](mask8 active, mask8 known, f64x8 /*number*/, f64x8 /*end*/)
      __attribute__((always_inline)) {
    prefetch_ahead(scene.grid, p, cells);
    if (const mask8 gap = active & ~known; any(gap)) {
      close(state.visible, gap, bins, lanes.visible);
      close(state.present, gap, bins, lanes.present);
      state.joined &= ~gap;
    }
  };
  const auto close_visible = [&](mask8 where) __attribute__((always_inline)) {
    close(state.visible, where, bins, lanes.visible);
  };
  const auto triangle = [&](mask8 where, const TriangleCut<f64x8>& cut, f64x8 d0, f64x8 d1)
      __attribute__((always_inline)) {
    state.pass(where, cut.start - scene.antenna_y_m, cut.rise, d0, d1, close_visible);
  };
  march(scene, p, end_m, cells, next, cell, triangle);
  store_cells(lanes, cells);
  for (int lane = 0; lane < kLanes; ++lane)
    lanes.state[lane] = {{state.horizon.d_m[lane], state.horizon.h_m[lane], false},
                         {state.visible.least2[lane], state.visible.greatest2[lane]},
                         {state.present.least2[lane], state.present.greatest2[lane]},
                         state.last_h_m[lane],
                         state.joined[lane] != 0};
  return at_roof;
}

}  // namespace obliq::OBLIQ_ISA
