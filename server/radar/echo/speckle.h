#pragma once
// Ground speckle (PAPER.md, eq. 13): every scatterer, a cell of the ground or of a building face, has a fixed
// complex amplitude drawn from an integer hash and a fixed phase reference point in the world.
#include <complex>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "server/radar/simd/echoes/bin_samples.h"
#include "server/radar/simd/echoes/face_cell.h"
#include "server/radar/simd/ground/ground_speckle.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "server/scene/exact_hit.h"
#include "terrain/base/hash.h"
#include "terrain/world.h"

namespace obliq {

/// Names a scatterer: a cell of side 2^level metres. Ground cells (x_cell, z_cell) lie on world axes; those
/// of a building face are counted from its centre, which is in the middle of cell (0, 0, 0).
struct Scatterer {
  /// The level of a face that lies in one cell, whatever its size: the face is the scatterer.
  static constexpr std::int16_t kWholeFace = -0x8000;

  std::int32_t x_cell = 0;
  std::int32_t z_cell = 0;
  std::uint32_t face = kNoFace;
  std::int16_t level = 0;
  std::uint8_t material = 0;
  std::int32_t y_cell = 0;  ///< of walls
  bool corner = false;      ///< of a wall with the ground before it: another scatterer, at the wall's foot

  bool operator==(const Scatterer&) const = default;
};

/// A scatterer in two numbers, equal when the scatterers are.
struct ScattererKey {
  std::uint64_t place;  ///< x_cell, z_cell: 32 bits each; of a face x_cell, y_cell: 21 each, z_cell: 22
  std::uint64_t kind;   ///< face: 32 bits, corner: one of the next 8, level: 16, material: 8

  static constexpr std::uint64_t kCorner = 1u << 24;

  explicit ScattererKey(std::uint64_t place_bits, std::uint64_t kind_bits)
      : place(place_bits), kind(kind_bits) {}
  explicit ScattererKey(const Scatterer& s)
      : place(s.face == kNoFace
                  ? static_cast<std::uint64_t>(static_cast<std::uint32_t>(s.x_cell)) << 32 |
                        static_cast<std::uint32_t>(s.z_cell)
                  : place_on_face(static_cast<std::uint64_t>(s.x_cell), static_cast<std::uint64_t>(s.y_cell),
                                  static_cast<std::uint64_t>(s.z_cell))),
        kind(static_cast<std::uint64_t>(s.face) << 32 | (s.corner ? kCorner : 0) |
             static_cast<std::uint32_t>(static_cast<std::uint16_t>(s.level)) << 8 | s.material) {}
  std::uint32_t face() const { return static_cast<std::uint32_t>(kind >> 32); }
  Scatterer scatterer() const {
    const auto level = static_cast<std::int16_t>(static_cast<std::uint16_t>(kind >> 8));
    const auto material = static_cast<std::uint8_t>(kind);
    const auto bits = static_cast<std::int64_t>(place);
    if (face() == kNoFace)
      return {static_cast<std::int32_t>(bits >> 32), static_cast<std::int32_t>(bits), face(), level,
              material};
    return {static_cast<std::int32_t>(bits >> 43),
            static_cast<std::int32_t>(bits << 42 >> 42),
            face(),
            level,
            material,
            static_cast<std::int32_t>(bits << 21 >> 43),
            (kind & kCorner) != 0};
  }
};

/// The bin that a scatterer's power lies in.
struct OwnBin {
  int range_bin = 0;
  SinCos left_edge{};  ///< bearing of its azimuth bin's left edge
};

/// Amplitude and phase of scatterers for one frame geometry. Immutable.
class SpeckleField {
 public:
  SpeckleField(const World& world, const glm::dvec3& antenna_m, double wavelength_m, double range_spacing_m,
               double azimuth_width_rad, std::int64_t seed, const OwnerBins& owners = {});

  const OwnerBins& owners() const { return owners_; }

  /// The scatterer of a sample. Cell side: the largest power of two metres that is at most half of
  /// min(range spacing, r0 x azimuth width), r0 the power of two at or below the slant range.
  Scatterer scatterer(double slant_range_m, const glm::dvec3& at_m, std::uint32_t face,
                      std::uint8_t material) const;

  /// What the scatterers of a face have in common (FaceEchoes).
  struct OnFace {
    glm::dvec3 centre_m;
    double reach_m;
    std::uint64_t hash;  ///< of the whole face
    bool wall;
  };
  OnFace on_face(std::uint32_t building, std::uint32_t face) const {
    const BuildingFace of = world_.buildings.face(building, face);
    return {of.centre_m, of.reach_m, mix64(seed_ ^ of.identity), of.wall};
  }
  /// The scatterer of a wall's corner with the ground, that of corner(), as if it were a face.
  OnFace on_corner(double slant_range_m, const glm::dvec3& at_m, std::uint32_t building, std::uint32_t face,
                   std::uint8_t material) const;
  /// Of the side of cells, by octave of slant range: [64].
  const double* cells_per_m() const { return cells_per_m_; }

  /// The scatterer of a wall's corner with the ground, at a place of its foot. One a cell of the wall's
  /// length.
  Scatterer corner(double slant_range_m, const glm::dvec3& at_m, std::uint32_t face,
                   std::uint8_t material) const;

  /// u_c exp(-j 4 pi r_c / lambda): circular Gaussian with mean square 1 for a cell, unit modulus for a face
  /// that is no larger than one, and for a corner.
  /// bin: with an owner rule (simd/echoes/scatterer_owner.h), that of the power.
  std::complex<double> response(const Scatterer& scatterer, const OwnBin& bin = {}) const;

  /// sqrt(power) response of the block's scatterers, of ground to six digits.
  void respond(const SpeckleBlock& block) const;
  /// The same where all of them are ground.
  void respond_ground(const SpeckleBlock& block) const;

  /// The ground cells by octave of slant range, in `cells`.
  void describe_cells(SwathCells& cells) const;

  /// Bits of its amplitude and phase in its own bin.
  std::uint64_t hash(const Scatterer& scatterer) const { return hash(scatterer, std::uint64_t{0}); }
  /// Where its phase is taken.
  glm::dvec3 reference_point(const Scatterer& scatterer) const;

 private:
  Scatterer of_face(double slant_range_m, const glm::dvec3& at_m, const BuildingFace& of, std::uint32_t face,
                    std::uint8_t material, bool corner = false) const;
  glm::dvec3 reference_on(const BuildingFace& of, std::uint32_t building, const Scatterer& s) const;
  /// As one after the other does.
  void respond_alone(const SpeckleBlock& block, int k) const;
  std::uint64_t hash(const Scatterer& scatterer, std::uint64_t owner) const;
  std::uint64_t hash_on(std::uint64_t identity, const Scatterer& scatterer, std::uint64_t owner) const;
  /// Its own bits, and by how many turns its phase is off them.
  struct Draw {
    std::uint64_t hash;
    double turns;
  };
  Draw draw(const Scatterer& scatterer, const glm::dvec3& from_antenna, const OwnBin& bin) const;

  const World& world_;
  glm::dvec3 antenna_m_;
  double wavelength_m_;
  std::uint64_t seed_;
  OwnerBins owners_;
  std::int16_t level_of_octave_[64];  // indexed by floor(log2 r), clamped to 0..63
  double cells_per_m_[64];            // 2^-level of the same octave: exact
};

}  // namespace obliq
