#pragma once
// Powers as the levels of the video plane.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/receiver/video.h"

namespace obliq {

/// A row at a time. For one thread at a time.
class VideoCoder {
 public:
  VideoCoder(const VideoScale& scale, std::size_t n_range);

  /// [n_range], to be filled: finite, 0 or more, in the unit of power.
  double* power() { return power_.data(); }
  /// The levels of power(), from plane[first] on.
  void code(std::size_t first, std::vector<std::uint8_t>& plane) { code(8, first, plane); }
  void code(std::size_t first, std::vector<std::uint16_t>& plane) { code(16, first, plane); }

 private:
  template <typename Level>
  void code(int bits, std::size_t first, std::vector<Level>& plane);

  VideoScale scale_;
  std::size_t n_range_;
  std::vector<double> power_;        ///< with what the kernel reads beyond
  std::vector<std::int32_t> level_;  ///< as long
};

/// The video of one look follows from I&Q. Planes that are not wanted stay as they are.
void add_video_of_iq(const VideoScale& scale, bool video8, bool video16, BinBlock& bins);

}  // namespace obliq
