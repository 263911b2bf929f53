#pragma once
// Legal frames of extreme shapes: settings at their limits, over bare hills and in a town.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/radar/bins.h"
#include "server/radar/geometry/pose.h"
#include "server/radar/settings.h"
#include "server/scene/scene.h"
#include "tests/support/heard_work.h"

namespace obliq::test {

struct HardFrame {
  std::shared_ptr<const Scene> scene;
  RadarSettings settings;
  Pose pose;
  std::string text;  ///< one line: the seed and what stands out
};

/// Nothing where the seed's settings are not legal, or do not fit their pose.
std::optional<HardFrame> hard_frame(std::uint64_t seed);

/// What was done of a frame, by one thread.
struct HardWork {
  FrameStats stats;
  std::int64_t products = 0;  ///< taps times bins of a beam's sums
  bool whole = false;
};
/// Plans and renders it, all of it heard.
HardWork render_heard(const HardFrame& frame, HeardWork& heard);

}  // namespace obliq::test
