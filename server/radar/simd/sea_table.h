#pragma once
// Mean reflectivity of the sea by the sine of grazing, for lanes side by side (echo/sea_echo.h fills the
// table).
#include <cstdint>

#include "server/radar/simd/float_lanes.h"

namespace obliq {

/// What a piece of water returns over what its material says, by its grazing angle and its bearing against
/// the wind. Steps are even in the bits of a float: 128 an octave, between which lines run.
struct SeaTable {
  static constexpr int kLog2StepsAnOctave = 7;
  static constexpr int kOctaves = 10;
  static constexpr int kSteps = kOctaves << kLog2StepsAnOctave;
  static constexpr float kLeastSine = 0x1p-10F;  ///< 0.06 degrees, below all that the model knows
  static constexpr std::int32_t kLeastBits = (127 - kOctaves) << 23;
  static constexpr int kRestBits = 23 - kLog2StepsAnOctave;

  float
      gamma[kSteps + 2];  ///< sigma0 / sin(grazing), linear; of wind from nowhere, or its mean over bearings
  float upwind[kSteps + 2];  ///< its factor is exp(upwind cos(bearing against the wind))
  float over_gamma[256];     ///< by material: 1 / its own gamma; 0: no sea
  bool has_wind;
  double curve_x, curve_z;  ///< second derivatives of the datum's height, 1/m: 0 or less
  double antenna_x_m, antenna_z_m;
  double wind_sin, wind_cos;  ///< world bearing that the wind comes from

  /// The sine of grazing on level water is (fall + d (lean + curve d)) / r: d its ground distance along a
  /// bearing, fall the antenna's height above it.
  double curve(double sine, double cosine) const { return curve_x * sine * sine + curve_z * cosine * cosine; }
  double lean(double sine, double cosine) const {
    return curve_x * antenna_x_m * sine + curve_z * antenna_z_m * cosine;
  }
};

#if defined(OBLIQ_ISA)

/// exp(x), |x| <= 1, to 3e-7: the Taylor series.
OBLIQ_LANES Lanes<T, n> exp_of_small(Lanes<T, n> x) {
  constexpr float kOverFactorials[] = {1.0F / 40320, 1.0F / 5040, 1.0F / 720, 1.0F / 120, 1.0F / 24,
                                       1.0F / 6,     0.5F,        1.0F,       1.0F};
  Lanes<T, n> sum = Lanes<T, n>{} + 1.0F / 362880;
  for (const float term : kOverFactorials) sum = sum * x + term;
  return sum;
}

/// The table's gamma. Lanes without surface may hold anything.
OBLIQ_LANES Lanes<T, n> sea_gamma(const SeaTable& table, Lanes<T, n> sine, Lanes<T, n> against_wind) {
  const Lanes<T, n> least = Lanes<T, n>{} + SeaTable::kLeastSine;
  const Lanes<T, n> at = min(select(sine > least, sine, least), Lanes<T, n>{} + 1.0F);
  const auto bits = OBLIQ_ISA::bits_as<std::int32_t>(at);
  const auto k = (bits - SeaTable::kLeastBits) >> SeaTable::kRestBits;
  const auto rest =
      converted<float>(bits & ((1 << SeaTable::kRestBits) - 1)) * (1.0F / (1 << SeaTable::kRestBits));
  const auto between = [&](const float* of) __attribute__((always_inline)) {
    const auto low = gather(of, k);
    return low + rest * (gather(of + 1, k) - low);
  };
  const Lanes<T, n> gamma = between(table.gamma);
  return table.has_wind ? gamma * exp_of_small(between(table.upwind) * against_wind) : gamma;
}

#endif

}  // namespace obliq
