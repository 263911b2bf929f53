#pragma once

namespace obliq {

/// What a radar does for clients that cannot keep up with it.
struct StreamConfig {
  int live_frames = 3;  ///< of a radar: a further one waits until all clients have done with one
  /// When a radar has waited for so long, newest-wins clients that hold its oldest frame up have it aborted.
  double abort_after_s = 1;
  double lossless_limit_s = 10;  ///< a lossless client that holds its radar up and takes nothing is dropped
};

}  // namespace obliq
