#pragma once
#include <cstdint>

#include "server/radar/samples.h"
#include "server/radar/simd/echoes/range_axis.h"
#include "server/radar/simd/ground/grid_view.h"
#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// The plates of a frame's pixels (PixelPlates): what all of them have in common.
struct PlateField {
  GroundView ground;
  const std::uint8_t* material;  ///< [nz - 1][nx - 1] of the cells; null: all are 0
  const float* raster_gamma;     ///< [nz - 1][nx - 1] of the cells; null: there is none
  RangeAxis axis;
  double reach_m;     ///< no plate is walked farther from its hit
  int look_cells;     ///< nor farther than this behind a crest
  double touching_m;  ///< kTouching_m
  bool incidence;     ///< whether a material's cross section depends on it
  /// The camera: half a pixel's sides on a viewing plane at distance 1, its pitch, the bearing of its centre.
  double half_width, half_height;
  double sin_pitch, cos_pitch;
  double sin_bearing, cos_bearing;
};

/// Rays and where they hit the surface; read up to a multiple of 8.
struct PlateRays {
  const double* dir_x;
  const double* dir_y;
  const double* dir_z;
  const double* slant_range_m;
};

/// Plates of eight rays: the visible ground that each pixel covers in its ray's vertical plane, outwards, cut
/// where the range bin, the material or what a gamma raster says changes.
struct GroundPlates {
  static constexpr int kLanes = 8;
  static constexpr int kMost = 32;
  using Row = double[kLanes];

  // The vertical planes, the hits in them, and half of the pixels' extents in slope.
  Row sin_bearing, cos_bearing;
  Row d_m, h_m, slope, half_extent;

  unsigned walked;   ///< the plates that are here, a bit each
  Row from_m, to_m;  ///< between which ground distances they were looked for

  /// Parts; a row has at most one of each plate. What is visible between two elevations has a share, the
  /// difference of their sines.
  int n;
  unsigned whose[kMost];
  Row bin[kMost];                   ///< -1: nearer than r_min; n_range: beyond r_max
  Row near_m[kMost], far_m[kMost];  ///< slant ranges of both ends
  Row near_d_m[kMost], far_d_m[kMost];
  Row near_sine[kMost], far_sine[kMost];
  Row cosines[kMost];  ///< of incidence, times the share; only with PlateField::incidence
  Row material[kMost];
  Row raster_gamma[kMost];  ///< only with PlateField::raster_gamma
};

/// Walks the plates of rays [first, first + 8), those of `wanted`, a bit each, over bare ground as walk_in
/// and walk_out (profile/local_sight.h) do: from where the ground comes up to the pixel's lower edge outwards
/// to its upper edge. Some are left: where range falls outwards, where no such start is found, where there
/// are very many parts.
OBLIQ_KERNEL(void, ground_plates, const PlateField&, const PlateRays&, int first, unsigned wanted,
             GroundPlates&);

/// What the samples of eight pixels have from their rays. [8] of each.
struct PlatePixels {
  const double* solid_angle_sr;
  const double* cos_incidence;
  const double* slant_range_m;
  const std::int32_t* azimuth_bin;
  double azimuth_offset_rad[GroundPlates::kLanes];
  const std::uint8_t* visible[GroundPlates::kLanes];  ///< [n_range] marks: no light goes to other bins
};

/// Appends a sample for each part of the walked plates, at most 8 kMost; they share their pixel's solid
/// angle. Returns the plates that have no part left.
OBLIQ_KERNEL(unsigned, plate_samples, const PlateField&, const PlatePixels&, const GroundPlates&,
             SampleBatch&);

}  // namespace obliq
