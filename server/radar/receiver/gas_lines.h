#pragma once
#include <span>

namespace obliq {

/// A spectral line of Rec. ITU-R P.676-12: its frequency, and six coefficients as the tables have them.
struct GasLine {
  double ghz;
  double a1, a2, a3, a4, a5, a6;
};
std::span<const GasLine> oxygen_lines();
std::span<const GasLine> water_lines();

}  // namespace obliq
