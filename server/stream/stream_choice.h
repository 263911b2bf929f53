#pragma once
#include <compare>
#include <vector>

#include "proto/bin_window.h"
#include "proto/plane_coding.h"
#include "terrain/base/errors.h"

namespace obliq::wire {
class Subscribe;
class RenderOnce;
}  // namespace obliq::wire

namespace obliq::stream {

/// How blocks are encoded. Watchers with the same format share blocks.
struct BlockFormat {
  wire::IqEncoding iq = wire::IqEncoding::cf32_le;  ///< means nothing for other planes
  wire::Compression compression = wire::Compression::none;
  int video_bits = 8;   ///< 8 or 16; means nothing for other planes
  wire::Window window;  ///< as asked for, not cut to any frame

  auto operator<=>(const BlockFormat&) const = default;
  /// The format for this plane: fields that do not apply to it have their defaults.
  BlockFormat of_plane(wire::Plane plane) const;
};

/// What a client asks for of a radar's frames.
struct StreamChoice {
  wire::PlaneSet planes = wire::kAllPlanes;
  BlockFormat format{};
  bool as_json = false;  ///< descriptors are JSON, for a browser
  bool truth = false;    ///< where targets are, too

  auto operator<=>(const StreamChoice&) const = default;
};

/// It says where targets are.
inline bool tells_truth(const StreamChoice& choice) {
  return choice.truth || (choice.planes & wire::kTargetPlane) != 0;
}

/// Reads what a request asks for, of a frame of so many bins; adds what is impossible to `errors`.
StreamChoice read_choice(const wire::Subscribe& request, int azimuth_bins, int range_bins,
                         std::vector<FieldError>& errors);
StreamChoice read_choice(const wire::RenderOnce& request, int azimuth_bins, int range_bins,
                         std::vector<FieldError>& errors);

}  // namespace obliq::stream
