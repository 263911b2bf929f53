#pragma once
#include "server/radar/simd/float_lanes.h"

namespace obliq {

/// One-way power gain over the sine of elevation about the antenna's own vertical, interpolated between even
/// steps. `gain` is null where the antenna has no pattern in elevation. Whoever fills it owns the table.
struct ElevationTable {
  static constexpr int kSteps = 8192;
  const float* gain = nullptr;  ///< [kSteps + 1]
  double from = 0;              ///< sine of the first
  double per_sine = 0;          ///< steps a unit of sine
  /// The sine about the antenna's vertical is that about the world's plus lean . horizontal offset / range.
  double lean_x = 0;
  double lean_z = 0;

  double at(double sine) const {
    const double at = (sine - from) * per_sine;
    const double step = at > 0 ? min(at, static_cast<double>(kSteps) - 1e-6) : 0;
    const auto k = static_cast<int>(step);
    const auto low = static_cast<double>(gain[k]);
    return low + (step - k) * (static_cast<double>(gain[k + 1]) - low);
  }
};

#if defined(OBLIQ_ISA)

OBLIQ_INLINE f32x16 elevation_gain(const ElevationTable& table, f32x16 sine) {
  const f32x16 at = (sine - static_cast<float>(table.from)) * static_cast<float>(table.per_sine);
  // Lanes without surface may hold anything, NaN too: they look up the first.
  const f32x16 step =
      min(select(at > 0.0F, at, f32x16{}), all_lanes(static_cast<float>(ElevationTable::kSteps) - 0.01F));
  const i32x16 k = truncated(step);
  const f32x16 low = gather(table.gain, k);
  return low + (step - floats_of(k)) * (gather(table.gain + 1, k) - low);
}

#endif

}  // namespace obliq
