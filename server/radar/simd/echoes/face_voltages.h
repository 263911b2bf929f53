#pragma once
#include <cstdint>

#include "server/radar/simd/echoes/cross_section.h"
#include "server/radar/simd/echoes/scatterer_owner.h"
#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// Echoes of building faces, [kMost] of everything. Read and written up to a multiple of 8.
struct FaceEchoes {
  static constexpr int kMost = 64;
  int n = 0;
  std::uint32_t at[kMost]{};        ///< range bin x 8 + azimuth bin of the wedge
  std::uint64_t material[kMost]{};  ///< beyond n: any that is in the table
  double light[kMost];              ///< solid angle, sr; or the power over EchoTable::factor where sec2 is 0
  double sec2[kMost];               ///< 1 / cos^2 of the incidence
  double range_m[kMost];
  double x_m[kMost], y_m[kMost], z_m[kMost];  ///< the place on the face, world frame
  // Of the face; of a scatterer that is `given`, its reference point and hash.
  double centre_x_m[kMost], centre_y_m[kMost], centre_z_m[kMost];
  double reach_m[kMost];
  std::uint64_t hash[kMost];
  std::uint64_t wall[kMost];   ///< 1: its cells are counted in height too
  std::uint64_t given[kMost];  ///< 1: the scatterer is known, its modulus 1
  // Found.
  double power_w[kMost];
  double re[kMost], im[kMost];
};

/// What all faces have in common: their cells, the bins that they belong to, and the edges of those that
/// their power lies in.
struct FaceBins {
  double antenna_x_m, antenna_y_m, antenna_z_m;
  const double* cells_per_m;  ///< [64] by octave of range, powers of 2
  OwnerBins owners;
  WedgeEdges edges;
};

/// Powers.
OBLIQ_KERNEL(void, face_powers, const EchoTable&, FaceEchoes&);
/// sqrt(power) response (SpeckleField::response), after the powers.
OBLIQ_KERNEL(void, face_voltages, double wavelength_m, const FaceBins&, FaceEchoes&);

}  // namespace obliq
