#pragma once
// Mean reflectivity of the sea by the sine of grazing, for lanes side by side (echo/sea_echo.h fills the
// table).
#include <cstdint>

#include "server/radar/simd/lanes/table_window.h"

namespace obliq {

/// What a piece of water returns over what its material says, by its grazing angle and its bearing against
/// the wind. Steps are even in the bits of a float: 64 an octave, each with its line.
struct SeaTable {
  static constexpr int kLog2StepsAnOctave = 6;
  static constexpr int kOctaves = 10;
  static constexpr int kSteps = kOctaves << kLog2StepsAnOctave;
  static constexpr float kLeastSine = 0.00174532837F;  ///< 0.1 degrees: the model's least grazing
  static constexpr int kRestBits = 23 - kLog2StepsAnOctave;
  static constexpr std::int32_t kFirstStep = (127 - kOctaves) << kLog2StepsAnOctave;

  /// sigma0 / sin(grazing), linear, is offset + rise sin(grazing), each of the step that the bits of the sine
  /// begin with, from kFirstStep on; of wind from nowhere, or its mean over bearings.
  float offset[kSteps + 1];
  float rise[kSteps + 1];
  /// Its factor is exp(upwind (1 - 2.8 grazing) cos(bearing against the wind)), grazing as far as the model
  /// goes (sea_clutter.h); 0 without wind.
  float upwind;
  float most_upwind_sine;
  /// Of a bearing that factor is a polynomial in the sine of grazing: to 0.0014 dB at 10 GHz, 0.003 at 35.
  static constexpr int kUpwindTerms = 3;
  double upwind_sines[kUpwindTerms];  ///< through which it goes
  float over_gamma[256];              ///< by material: 1 / its own gamma; 0: no sea
  double curve_x, curve_z;            ///< second derivatives of the datum's height, 1/m: 0 or less
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

/// What each piece of water in `wanted` returns over the gamma of its material; other lanes may hold
/// anything. upwind: [kUpwindTerms][16] of these runs. The window: of these runs, kept from one call to the
/// next.
OBLIQ_LANES Lanes<T, n> sea_gamma(const SeaTable& table, Lanes<T, n> sine, const float (*upwind)[16],
                                  Lanes<MaskOf<float>, n> wanted, TableWindow& window) {
  const Lanes<T, n> least = Lanes<T, n>{} + SeaTable::kLeastSine;
  // Of a NaN the least. A piece's mean sine, from its ends, may be above 1 on a slope below the antenna.
  const Lanes<T, n> at = min(max(least, sine), Lanes<T, n>{} + 1.0F);
  const auto step = OBLIQ_ISA::bits_as<std::int32_t>(at) >> SeaTable::kRestBits;
  const Pairs<Lanes<T, n>> line =
      gather_both(table.offset, table.rise, SeaTable::kFirstStep, step, wanted, window);
  const Lanes<T, n> gamma = line.first + line.second * at;
  if (!(table.upwind > 0)) return gamma;
  const Lanes<T, n> s = min(at, Lanes<T, n>{} + table.most_upwind_sine);
  const auto term = [&](int power) __attribute__((always_inline)) {
    return load_as<Lanes<T, n>>(upwind[power]);
  };
  return gamma * (term(0) + s * (term(1) + s * term(2)));
}

#endif

}  // namespace obliq
