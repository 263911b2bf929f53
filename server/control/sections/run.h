#pragma once
// [accuracy] and [run]: the error allowed in frames, and how they are rendered.
#include <cmath>
#include <limits>

namespace obliq {

struct Section;

/// [accuracy] of a scene file: the largest error allowed in frames. Cell size and pixels follow from it.
struct AccuracyWish {
  double max_power_error_db =
      std::numeric_limits<double>::infinity();       ///< median |10 log10 P/T|; infinity: any
  double max_gap_fraction = 1;                       ///< of the lit bins, 0..1; 1: any
  static constexpr double kUsualGapFraction = 0.05;  ///< where only an error is given: an error on the bins
                                                     ///< that happen to be filled says little

  bool asks() const { return std::isfinite(max_power_error_db) || max_gap_fraction < 1; }
};

extern const Section kAccuracySection;
extern const Section kRunSection;

}  // namespace obliq
