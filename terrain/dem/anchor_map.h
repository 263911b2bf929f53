#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>

#include "terrain/frames.h"
#include "terrain/world_spec.h"

namespace obliq {

/// From a world frame's (x, z) to those of another origin, the anchor of made-up ground, along the ellipsoid:
/// so that the ground stays where it is on the earth when the scene's origin moves. Without an anchor, or
/// with the frame's own origin, the identity, bit for bit. Immutable.
class AnchorMap {
 public:
  AnchorMap(const WorldFrame& frame, const std::optional<LonLat>& anchor);

  glm::dvec2 exact(const glm::dvec2& p) const;

  /// Points of one z, interpolated between exact ones every kStep_m of the frame: off by less than a
  /// millimetre with origins 300 km apart (second derivative distance / R^2, times kStep_m^2 / 8). The same
  /// point gets the same bits whatever is asked before. For one thread.
  class Row {
   public:
    glm::dvec2 at(double x_m);

   private:
    friend class AnchorMap;
    Row(const AnchorMap& map, double z_m);
    glm::dvec2 column(double i) const;

    const AnchorMap& map_;
    double z_m_;
    double first_ = 0;  ///< number of the left exact column
    bool known_ = false;
    glm::dvec2 left_{0.0};
    glm::dvec2 right_{0.0};
  };
  Row row(double z_m) const { return {*this, z_m}; }

 private:
  static constexpr double kStep_m = 256;

  const WorldFrame& frame_;
  std::optional<WorldFrame> anchor_;
};

}  // namespace obliq
