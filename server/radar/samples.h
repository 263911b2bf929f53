#pragma once
// What the stages of the pipeline pass on: visible pieces of surface, whoever found them.
#include <array>
#include <cstdint>

#include "server/radar/bins.h"
#include "server/scene/exact_hit.h"

namespace obliq {

constexpr int kBatch = 1024;  ///< rays or samples a batch: 64 packets, which stay in the first-level caches

/// Samples waiting for room in a batch.
struct Sample {
  std::int32_t azimuth_bin = 0;
  double slant_range_m = 0;
  double solid_angle_sr = 0;
  double cos_incidence = 0;
  double azimuth_offset_rad = 0;
  double sin_elevation = 0;
  double x_m = 0;
  double z_m = 0;
  std::uint32_t face = kNoFace;
  std::uint8_t material = 0;
};

/// Visible pieces of surface, from any source. Nothing here or after it knows of pixels.
struct SampleBatch {
  int n = 0;
  std::array<std::int32_t, kBatch> azimuth_bin;
  std::array<double, kBatch> slant_range_m;
  std::array<double, kBatch> solid_angle_sr;
  std::array<double, kBatch> cos_incidence;  ///< 0..1
  std::array<double, kBatch>
      azimuth_offset_rad;  ///< clockwise from the sector's centre, for the antenna pattern
  std::array<double, kBatch> sin_elevation;
  std::array<double, kBatch> x_m;  ///< world position, for the ground cell
  std::array<double, kBatch> z_m;
  std::array<std::uint32_t, kBatch> face;  ///< building face, kNoFace on ground
  std::array<std::uint8_t, kBatch> material;
};

/// Finds the visible pieces of surface of one wedge, batch by batch, in a fixed order. What comes after knows
/// nothing of rays, pixels or planes.
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// Fills the batch (possibly with nothing) and counts what it took; false when nothing was left to look at.
  /// Looks at a bounded part at a time, because a rendering pauses only between batches.
  virtual bool next(SampleBatch& samples, FrameStats& stats) = 0;
};

}  // namespace obliq
