#pragma once
#include <cstdint>

#include "server/radar/simd/echoes/cross_section.h"
#include "server/radar/simd/echoes/scatterer_owner.h"
#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// Echoes of building faces, [kMost] of everything. Read and written up to a multiple of 8.
struct FaceEchoes {
  static constexpr int kMost = 512;
  int n = 0;
  std::uint32_t at[kMost]{};        ///< range bin x 8 + azimuth bin of the wedge
  std::uint64_t material[kMost]{};  ///< beyond n: any that is in the table
  double power_w[kMost];            ///< of a unit of cross section for each unit of projected area
  double sec2[kMost];               ///< 1 / cos^2 of the incidence; 0: power_w has the cross section
  double x_m[kMost], y_m[kMost], z_m[kMost];  ///< the scatterer's reference point, from the antenna
  std::uint64_t hash[kMost];
  std::uint64_t whole[kMost];  ///< 1: the face is the scatterer, its modulus 1; 0: a cell of it
};

/// The bins that faces belong to, and the edges of those that their power lies in.
struct FaceBins {
  OwnerBins owners;
  WedgeEdges edges;
};

/// Multiplies powers by the cross section, and works out sqrt(power) response (SpeckleField::response).
OBLIQ_KERNEL(void, face_voltages, const EchoTable&, double wavelength_m, const FaceBins&, FaceEchoes&,
             double* re, double* im);

}  // namespace obliq
