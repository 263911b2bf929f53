#pragma once
// The edges of a house's part as its sub-columns need them, eight at a time.
#include "server/radar/simd/buildings/sub_columns.h"
#include "server/radar/simd/lanes/lanes.h"

namespace obliq::OBLIQ_ISA {

/// What the edges of a part have for all sub-columns.
struct Edges {
  float from[ConvexShape::kMost], to[ConvexShape::kMost];  // tangents
  float right_m[ConvexShape::kMost];                       // that an edge goes
  float half_ahead_m[ConvexShape::kMost];
  float cross[ConvexShape::kMost];
  float nearest_m[ConvexShape::kMost], farthest_m[ConvexShape::kMost];
  float bend[ConvexShape::kMost];

  OBLIQ_INLINE explicit Edges(const ConvexShape& shape) {
    constexpr int kEdges = 8;
    using Each = Lanes<float, kEdges>;
    for (int e = 0; e < shape.n; e += kEdges) {
      const auto t0 = load_as<Each>(shape.tangent + e);
      const auto t1 = load_as<Each>(shape.tangent + e + 1);
      const auto right0 = load_as<Each>(shape.right_m + e);
      const auto ahead0 = load_as<Each>(shape.ahead_m + e);
      const auto ahead1 = load_as<Each>(shape.ahead_m + e + 1);
      const Each dr = load_as<Each>(shape.right_m + e + 1) - right0;
      const Each da = ahead1 - ahead0;
      const Each of_cross = ahead0 * dr - right0 * da;
      const Each of_bend = da / of_cross;
      to_memory(from + e, min(t0, t1));
      to_memory(to + e, max(t0, t1));
      to_memory(right_m + e, dr);
      to_memory(half_ahead_m + e, 0.5F * da);
      to_memory(cross + e, of_cross);
      to_memory(nearest_m + e, min(ahead0, ahead1));
      to_memory(farthest_m + e, max(ahead0, ahead1));
      to_memory(bend + e, max(of_bend, -of_bend));
    }
  }
};

}  // namespace obliq::OBLIQ_ISA
