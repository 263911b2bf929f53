#pragma once
#include <optional>
#include <string>

#include "server/output/ground_map_png.h"

namespace obliq {

/// Keeps a stream's grey scale at that of the first frame that showed something, until the radar's settings
/// change: two pictures of it can be compared.
class SteadyScale {
 public:
  /// `given`: for all frames.
  explicit SteadyScale(std::optional<DbRange> given) : given_(given) {}
  /// For the next frame; nothing: whatever it shows.
  std::optional<DbRange> next(const wire::FrameDescriptor& descriptor);
  void drawn(std::optional<DbRange> scale) { kept_ = scale; }

 private:
  std::optional<DbRange> given_;
  std::optional<DbRange> kept_;
  std::string settings_;  ///< of the frames it was kept for
};

}  // namespace obliq
