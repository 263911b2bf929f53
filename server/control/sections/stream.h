#pragma once
// [stream]: what a radar does for clients that cannot keep up with it.

namespace obliq {

struct Section;

/// What a radar does for clients that cannot keep up with it.
struct StreamConfig {
  int live_frames = 3;
  double abort_after_s = 1;
  double lossless_limit_s = 10;
};

extern const Section kStreamSection;

}  // namespace obliq
