#pragma once
// The cells of a building's face: counted from its centre, which is in the middle of cell (0, 0, 0), so that
// no wall runs along the edge between two.
#include "server/radar/simd/lanes/lanes.h"
#include "terrain/base/hash.h"

namespace obliq {

/// Of a face from its centre, so that their numbers fit 21 bits.
constexpr double kMostCellsOfFace = 0xfffff;

/// The cell that a place on a face lies in: whole numbers, 0 of a face that lies in one cell, whatever its
/// size.
template <typename Real>
struct FaceCell {
  Mask<Real> whole;
  Real x, y, z;
};

/// (x, y, z): the place, from the face's centre. cells_per_m: of its side. y counts where `by_height`.
template <typename Real>
OBLIQ_INLINE FaceCell<Real> cell_on_face(Real x_m, Real y_m, Real z_m, Real reach_m, Real cells_per_m,
                                         Mask<Real> by_height) {
  const Mask<Real> whole = reach_m * cells_per_m <= 0.5;
  const auto number = [&](Real from_centre_m) __attribute__((always_inline)) {
    return clamp(floor(from_centre_m * cells_per_m + 0.5), broadcast<Real>(-kMostCellsOfFace),
                 broadcast<Real>(kMostCellsOfFace));
  };
  return {whole, select(whole, Real{}, number(x_m)), select(whole | inverse(by_height), Real{}, number(y_m)),
          select(whole, Real{}, number(z_m))};
}

/// ScattererKey::place of such numbers, in two's complement.
template <typename Word>
OBLIQ_INLINE Word place_on_face(Word x, Word y, Word z) {
  return (x & 0x1fffffull) << 43 | (y & 0x1fffffull) << 22 | (z & 0x3fffffull);
}

/// Bits of a cell's amplitude and phase. face_hash: of the face, that of a whole one; kind: the low half of
/// ScattererKey::kind, and of whose bin it is not.
template <typename Word>
OBLIQ_INLINE Word hash_of_face_cell(Word face_hash, Word place, Word kind) {
  return mix_words(mix_words(face_hash ^ place) ^ kind);
}

}  // namespace obliq
