#pragma once
// What the stages of the pipeline pass on: visible parts of the surface, whichever source found them.
#include <cstddef>
#include <cstdint>

#include "terrain/buildings/buildings.h"

namespace obliq {

struct ExactHit;    // server/scene/exact_hit.h
struct FrameStats;  // server/radar/bins.h

constexpr int kBatch = 1024;  ///< rays or samples a batch: 64 packets, which stay in the first-level caches

/// A visible part of the surface, small enough to lie in one range bin.
struct Sample {
  std::int32_t azimuth_bin = 0;
  double slant_range_m = 0;
  double solid_angle_sr = 0;
  double cos_incidence = 0;       ///< 0..1
  double azimuth_offset_rad = 0;  ///< clockwise from the sector's centre, for the antenna pattern
  double sin_elevation = 0;
  double x_m = 0;  ///< world position, for the ground cell
  double z_m = 0;
  std::uint32_t face = kNoFace;  ///< building face, kNoFace on ground
  std::uint8_t material = 0;
  float raster_gamma = 1;  ///< World::raster_gamma of the ground
};

/// Samples as arrays, whatever they were made from. Plain arrays, because the kernels (simd/)
/// share this header and no inline function that they call may be compiled twice.
struct SampleBatch {
  int n = 0;
  std::int32_t azimuth_bin[kBatch];
  double slant_range_m[kBatch];
  double solid_angle_sr[kBatch];
  double cos_incidence[kBatch];
  double azimuth_offset_rad[kBatch];
  double sin_elevation[kBatch];
  double x_m[kBatch];
  double z_m[kBatch];
  std::uint32_t face[kBatch];
  std::uint8_t material[kBatch];
  float raster_gamma[kBatch];  ///< only where the scene has gamma rasters

  bool full() const { return n == kBatch; }
  /// Not when full.
  void push(const Sample& sample) {
    const auto k = static_cast<std::size_t>(n++);
    azimuth_bin[k] = sample.azimuth_bin;
    slant_range_m[k] = sample.slant_range_m;
    solid_angle_sr[k] = sample.solid_angle_sr;
    cos_incidence[k] = sample.cos_incidence;
    azimuth_offset_rad[k] = sample.azimuth_offset_rad;
    sin_elevation[k] = sample.sin_elevation;
    x_m[k] = sample.x_m;
    z_m[k] = sample.z_m;
    face[k] = sample.face;
    material[k] = sample.material;
    raster_gamma[k] = sample.raster_gamma;
  }
};

/// Finds the visible surface of one wedge, batch by batch, in a fixed order. Later stages see no
/// rays, pixels or profiles.
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// Fills the batch, possibly with nothing, and counts what it took; false when nothing was left to look at.
  /// Looks at a bounded part of the wedge, because a rendering pauses only between batches.
  virtual bool fill(SampleBatch& samples, FrameStats& stats) = 0;
};

/// Receives every hit with its pixel, for the perspective textures. Called from any thread, for each pixel at
/// most once.
class HitObserver {
 public:
  virtual ~HitObserver() = default;
  virtual void on_hit(std::uint32_t pixel, double azimuth_offset_rad, const ExactHit& hit) = 0;
};

}  // namespace obliq
