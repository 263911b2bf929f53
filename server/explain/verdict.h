#pragma once
#include "server/explain/explanation.h"

namespace obliq {

// A change counts when it reaches any of these. A tenth of a decibel and half a range bin are what thresholds
// are worked out for; a radar that is calibrated to a decibel is a good one.
constexpr double kNoticeableMedian_db = 0.1;
constexpr double kNoticeable95_db = 1;
constexpr double kNoticeableShare = 0.01;  ///< of the lit bins: by more than 1 dB, gone or new
constexpr double kNoticeableTotal_db = 0.1;
constexpr double kNoticeableShift_bins = 0.5;  ///< range bins

/// A change must be this much larger than the measurement's own noise to be told from it.
constexpr double kAboveNoise = 2;

/// Sets verdict and below_frustum_noise from the numbers.
void decide(Comparison& comparison, const Explanation& all);

}  // namespace obliq
