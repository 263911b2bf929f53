#pragma once
#include <string>

#include "server/radar/bins.h"
#include "server/radar/settings.h"

namespace obliq {

/// More of a frame's lit bins without a sample than this are worth a warning, and no more than this is what
/// frustum.quality = "oblique" looks for.
constexpr double kMostUnsampled = 0.03;

inline bool is_undersampled(const FrameStats& stats) { return stats.unsampled_share() > kMostUnsampled; }

/// How many lit bins hold no sample, and what would mend it; empty where they are few, or where nobody asked
/// for states.
std::string unsampled_warning(const FrameStats& stats, const RadarSettings& settings);

}  // namespace obliq
