#pragma once
// What each scatterer gives to each bin, P_bc of PAPER.md, worked out anew from the samples: own cell
// arithmetic, own radar equation. An oracle for the speckle of whole frames.
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <map>
#include <tuple>
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/samples.h"
#include "server/scene/exact_hit.h"

namespace obliq::test {

/// A ground cell of side_m with its south-west corner at (x, z) = (x_cell, z_cell) side_m; or a cell of a
/// building face, so many sides from the face's centre to its own; or, with side_m 0, a face that is no
/// larger than a cell.
struct Cell {
  double side_m = 0;
  std::int64_t x_cell = 0;
  std::int64_t z_cell = 0;
  std::int64_t y_cell = 0;
  std::uint32_t face = kNoFace;
  std::uint8_t material = 0;

  auto operator<=>(const Cell&) const = default;
};

/// Power by scatterer of one bin, watts.
using BinShares = std::map<Cell, double>;

/// The point that a cell's phase refers to: the middle of a face's cell, or the ground at the cell's middle.
glm::dvec3 reference_point_m(const World& world, const Cell& cell);

/// Ground and buildings, both with constant gamma: 1 for ground, 3 for buildings.
std::vector<Material> constant_gamma_materials();

/// Calls use(batch, k) for every sample of a frame, wedge by wedge as the renderer asks for them.
void for_each_sample(const ScenePlan& plan, const std::function<void(const SampleBatch&, std::size_t)>& use);

/// The power that a sample's return has by the radar equation, own arithmetic. The sample's material has
/// constant gamma and the antenna a gain of 1.
double sample_power_w(const ScenePlan& plan, const SampleBatch& batch, std::size_t k);

/// Shares of all bins, [azimuth bins][range bins].
std::vector<BinShares> shares_of_bins(const ScenePlan& plan);

/// What a frame without a beam looks at, or an exception with what was wrong.
std::shared_ptr<const ScenePlan> plan_or_throw(std::shared_ptr<const Scene> scene, RadarSettings settings,
                                               const Pose& pose);

/// 4 pi r / lambda, r the distance between two points, in long double.
long double round_trip_phase_rad(const glm::dvec3& antenna_m, const glm::dvec3& point_m,
                                 double frequency_ghz);

/// exp(j phase), the phase in long double.
inline std::complex<double> turned(long double phase_rad) {
  return {static_cast<double>(std::cos(phase_rad)), static_cast<double>(std::sin(phase_rad))};
}

}  // namespace obliq::test
