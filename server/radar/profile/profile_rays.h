#pragma once
// First hits of rays without a ray tracer. Rays that lie in one vertical profile meet a height field and the
// prisms on it in order of elevation, so one march of the profile answers them all: exactly, in double.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "server/radar/profile/roofs.h"
#include "server/radar/simd/exact_math.h"
#include "server/radar/simd/kernels.h"
#include "server/scene/scene.h"

namespace obliq {

/// Answers the same rays, by elevation, in up to eight vertical profiles at a time. Immutable.
class ProfileRays {
 public:
  static constexpr int kMostProfiles = RayProfiles::kLanes;
  /// What a ray meets: 2 (j nx + i), + 1 for the upper triangle of ground cell (i, j), or kFace + a building
  /// face, or nothing, or kUnder where it passes under
  /// the far edge of a void, and what it meets there is not known.
  static constexpr std::uint32_t kFace = 0x80000000u;
  static constexpr std::uint32_t kUnder = kUnderVoid;
  static constexpr std::uint32_t kNothing = 0xffffffffu;

  /// `elevation`: rising, above -pi/2 and below pi/2. Hits lie at ground distances up to `reach_m`.
  /// Throws std::length_error when the grid has 2^30 posts or more. `kernels`: for tests.
  ProfileRays(const Scene& scene, const glm::dvec3& antenna_m, std::span<const SinCos> elevation,
              double reach_m, const Kernels& kernels = widest_kernels());

  std::size_t rays() const { return slope_.size() - 1; }

  /// Rays [first, first + count), by elevation.
  struct Run {
    std::size_t first;
    std::size_t count;
  };

  /// First hits of a run of rays along bearings (sin and cos of world angles): slant_range_m[profile *
  /// run.count + ray - run.first], 0 where there is none, and surface, the same. `buildings`: those that the
  /// profiles may meet. A ray's answer does not depend on the run.
  void answer(std::span<const SinCos> bearings, std::span<const std::uint32_t> buildings, Run run,
              std::span<double> slant_range_m, std::span<std::uint32_t> surface) const;
  /// Of all rays.
  void answer(std::span<const SinCos> bearings, std::span<const std::uint32_t> buildings,
              std::span<double> slant_range_m, std::span<std::uint32_t> surface) const {
    answer(bearings, buildings, {0, rays()}, slant_range_m, surface);
  }

 private:
  struct Roofs;
  double start_m(std::size_t ray) const;
  void pass_roofs(std::size_t profile, Roofs& roofs, const RayRows& rows, std::size_t first_ray,
                  RayProfiles& lanes) const;

  const World& world_;
  glm::dvec3 antenna_m_;
  GroundView ground_;
  const Kernels& kernels_;
  std::vector<double> slope_;   // [rays + 1]
  std::vector<double> secant_;  // [rays + 1]
  double top_m_;                // of all that stands there, above the antenna
  double reach_m_;
};

}  // namespace obliq
