#pragma once
// Ground speckle (design section 3): every scatterer, a ground cell or a building face, has a fixed complex
// amplitude drawn from an integer hash and a fixed phase reference point in the world.
#include <complex>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "server/radar/speckle_lanes.h"
#include "server/scene/exact_hit.h"
#include "terrain/hash.h"
#include "terrain/world.h"

namespace obliq {

/// Names a scatterer: a building face, or a ground cell (x_cell, z_cell) of side 2^level metres.
struct Scatterer {
  std::int32_t x_cell = 0;
  std::int32_t z_cell = 0;
  std::uint32_t face = kNoFace;
  std::int16_t level = 0;
  std::uint8_t material = 0;

  bool operator==(const Scatterer&) const = default;
};

/// Amplitude and phase of scatterers for one frame geometry. Immutable.
class SpeckleField {
 public:
  SpeckleField(const World& world, const glm::dvec3& antenna_m, double wavelength_m, double range_spacing_m,
               double azimuth_width_rad, std::int64_t seed);

  /// The scatterer of a sample. Cell side: the largest power of two metres that is at most half of
  /// min(range spacing, r0 x azimuth width), r0 the power of two at or below the slant range.
  Scatterer scatterer(double slant_range_m, double x_m, double z_m, std::uint32_t face,
                      std::uint8_t material) const;

  /// u_c exp(-j 4 pi r_c / lambda): circular Gaussian with mean square 1 for ground, unit modulus for a face.
  std::complex<double> response(const Scatterer& scatterer) const;

  /// sqrt(power) response of block.n scatterers of power block.power_w, the same to the bit, left in block.re
  /// and block.im. What else is in the block is written over.
  void respond(const Scatterer* scatterers, SpeckleBlock& block) const;

  std::uint64_t hash(const Scatterer& scatterer) const;

 private:
  glm::dvec3 reference_point(const Scatterer& scatterer) const;

  const World& world_;
  glm::dvec3 antenna_m_;
  double wavelength_m_;
  std::uint64_t seed_;
  std::int16_t level_of_octave_[64];  // indexed by floor(log2 r), clamped to 0..63
  double cells_per_m_[64];            // 2^-level of the same octave: exact
};

}  // namespace obliq
