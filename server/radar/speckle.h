#pragma once
// Ground speckle (design section 3): every scatterer, a ground cell or a building face, has a fixed complex
// amplitude drawn from an integer hash and a fixed phase reference point in the world.
#include <complex>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "server/radar/place_lanes.h"
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

/// A scatterer in two numbers, equal when the scatterers are.
struct ScattererKey {
  std::uint64_t place;  ///< x_cell, z_cell: 32 bits each
  std::uint64_t kind;   ///< face: 32 bits, level: 16 of the next 24, material: 8

  explicit ScattererKey(std::uint64_t place_bits, std::uint64_t kind_bits)
      : place(place_bits), kind(kind_bits) {}
  explicit ScattererKey(const Scatterer& s)
      : place(static_cast<std::uint64_t>(static_cast<std::uint32_t>(s.x_cell)) << 32 |
              static_cast<std::uint32_t>(s.z_cell)),
        kind(static_cast<std::uint64_t>(s.face) << 32 |
             static_cast<std::uint32_t>(static_cast<std::uint16_t>(s.level)) << 8 | s.material) {}
  std::uint32_t face() const { return static_cast<std::uint32_t>(kind >> 32); }
  Scatterer scatterer() const {
    return {static_cast<std::int32_t>(static_cast<std::uint32_t>(place >> 32)),
            static_cast<std::int32_t>(static_cast<std::uint32_t>(place)), face(),
            static_cast<std::int16_t>(static_cast<std::uint16_t>(kind >> 8)),
            static_cast<std::uint8_t>(kind)};
  }
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

  /// sqrt(power) response of the block's scatterers, the same to the bit.
  void respond(const SpeckleBlock& block) const;

  /// The ground cells by octave of slant range, in `cells`.
  void describe_cells(SwathCells& cells) const;

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
