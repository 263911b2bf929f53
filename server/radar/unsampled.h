#pragma once
#include <string>

#include "server/radar/bins.h"
#include "server/radar/settings.h"

namespace obliq {

/// A larger share of lit bins without a sample is worth a warning; frustum.quality = "oblique" looks for no
/// larger one.
constexpr double kMostUnsampled = 0.03;

inline bool is_undersampled(const FrameStats& stats) { return stats.unsampled_share() > kMostUnsampled; }

/// How many lit bins hold no sample, and the remedy; empty where they are few or the states are not known.
std::string unsampled_warning(const FrameStats& stats, const RadarSettings& settings);

}  // namespace obliq
