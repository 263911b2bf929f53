#pragma once
#include <cstdint>
#include <vector>

#include "server/accuracy/bin_errors.h"

namespace obliq {

/// How the power in the bins differs when the model is changed. Lit bins are those of design section 3, with
/// the unchanged planes in the truth's place.
struct PowerChange {
  std::uint64_t lit = 0;  ///< lit bins of the unchanged scene
  double median_db = 0;   ///< of |10 log10 P'/P| over lit bins with P' > 0
  double percentile95_db = 0;
  double over_1_db = 0;  ///< share of the lit bins whose power changes by more than 1 dB, to nothing included
  double vanished = 0;   ///< lit bins that go dark (P' = 0), as a share of the lit ones
  double appeared = 0;   ///< dark bins that become lit ones, as a share of the lit ones
  double total_ratio = 1;  ///< total P' over total P

  /// Of all power nothing is left, and no decibels say so.
  bool nothing_left() const { return !(total_ratio > 0); }
  /// 10 log10 of the total's ratio; -infinity when nothing is left.
  double total_db() const;
};

/// The larger of each measure.
PowerChange larger_of(const PowerChange& a, const PowerChange& b);

/// Compares two planes [n_azimuth][n_range] of the same bins.
PowerChange power_change(const std::vector<double>& power_w, const std::vector<double>& changed_w,
                         const RangeBins& ranges);

}  // namespace obliq
