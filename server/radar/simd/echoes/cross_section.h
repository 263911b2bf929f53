#pragma once
// The power that comes back from surface, without range: the antenna in elevation, and the cross section
// (ScatteringTable) of constant gamma and of geometric optics, for lanes side by side.
#include "server/radar/simd/echoes/sea_table.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "server/radar/simd/lanes/float_lanes.h"

namespace obliq {

/// One-way power gain over the sine of elevation about the antenna's own vertical, interpolated between even
/// steps. `gain` is null where the antenna has no pattern in elevation. The owner of the table fills it.
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

OBLIQ_LANES Lanes<T, n> elevation_gain(const ElevationTable& table, Lanes<T, n> sine) {
  const auto at = (sine - static_cast<float>(table.from)) * static_cast<float>(table.per_sine);
  // Lanes without surface may hold anything, NaN too: they look up the first.
  const auto step = min(select(at > 0.0F, at, Lanes<T, n>{}),
                        Lanes<T, n>{} + (static_cast<float>(ElevationTable::kSteps) - 0.01F));
  const auto k = converted<std::int32_t>(step);
  const auto low = gather(table.gain, k);
  return low + (step - converted<float>(k)) * (gather(table.gain + 1, k) - low);
}

#endif

/// What the power of a surface follows from, by material: constant gamma, or geometric optics with it as the
/// floor (ScatteringTable).
struct EchoTable {
  double factor;             ///< K = P_t G^2 lambda^2 / (4 pi)^3
  bool range_normalisation;  ///< powers times r^4
  bool any_lobes;            ///< a peak that is not 0
  bool sines;                ///< the elevation of echoes is wanted
  double gamma[256];
  float gamma_f[256];
  double peak[256];
  double over_two_slope2[256];
  ElevationTable elevation;
  const SeaTable* sea;  ///< of bare ground; null: none
};

/// The shortest wavelength that is allowed. The radar equation is one of the far field: nearer than this it
/// means nothing, and at 0, an antenna against a wall, it divides by it.
constexpr double kNearest_m = 1e-3;

#if defined(OBLIQ_ISA)

/// Cross section of a unit of projected area. sec2: 1 / cos^2 of the incidence.
OBLIQ_INLINE f64x8 cross_section_of_area(const EchoTable& table, u64x8 material, f64x8 sec2) {
  const f64x8 gamma = gather(table.gamma, material);
  const f64x8 peak = gather(table.peak, material);
  if (!any(peak > 0.0)) return gamma;
  constexpr double kEdgeOn2 = 1e12;  // as ScatteringTable's kEdgeOn
  const f64x8 lobe = peak * exp_of_negative((1.0 - sec2) * gather(table.over_two_slope2, material)) * sec2 *
                     sec2 * sqrt(sec2);
  return gamma + select((peak > 0.0) & (sec2 < kEdgeOn2), lobe, f64x8{});
}

#endif

}  // namespace obliq
