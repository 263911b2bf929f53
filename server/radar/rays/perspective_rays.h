#pragma once
#include <array>
#include <vector>

#include "server/radar/rays/packets.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/scene_plan.h"
#include "server/radar/simd/ground/rays.h"

namespace obliq {

/// Generates the rays of one wedge, of the symmetric and oblique frusta, in a fixed order that keeps packets
/// compact: squares of pixels (packets.h), back and forth. Every pixel of the frame belongs to exactly one
/// azimuth bin, known before its ray is traced, because a ray stays in its vertical plane. The pixels of one
/// azimuth bin in a row are a run of columns, because all directions of a row lie in one line: the run's ends
/// are where that line meets the bin's edges.
class PerspectiveRays {
 public:
  static constexpr int kMostPixels = kBatch;

  PerspectiveRays(const ScenePlan& plan, AzimuthRange range);
  /// Fills the batch, possibly with nothing: looks at kMostPixels at most. False when no pixel was left.
  bool generate(RayBatch& batch);

  /// Pixels that wait for their rays, by squares of 8 rows, with room to grow into.
  static std::int64_t bytes(const RadarSettings& settings) {
    return std::int64_t{8} * settings.pixel_columns * std::int64_t{sizeof(Pixel) + sizeof(int)} * 4 / 3;
  }

 private:
  /// Part of an azimuth bin, all of it ahead of the antenna or all behind.
  struct BearingInterval {
    int bin;
    bool ahead;               // between -90 and 90 degrees
    double tan_from, tan_to;  // of the bearing offsets at its ends; infinite at +-90 degrees
  };
  struct Run {
    int bin;
    PixelSpan columns;
  };
  struct Pixel {
    int row, column, bin;
    double up_m, ahead_m;
  };

  void add_intervals(int bin, double from, double to);
  int column_at(double x_m) const;
  void begin_rows();
  PixelSpan add_row(int row);
  void take(std::size_t n);
  void generate_waiting(RayBatch& batch);

  const PerspectiveFrustum& camera_;
  PixelCamera pixel_camera_;
  std::vector<BearingInterval> intervals_;
  int next_row_ = 0;
  std::vector<Run> runs_;        // of a row, by column
  std::vector<Pixel> waiting_;   // pixels of some rows, from taken_ on
  std::vector<int> by_squares_;  // their numbers, in the order of packets
  std::size_t taken_ = 0;
  PixelList pixels_;
  std::array<std::uint16_t, kBatch> packet_order_;  // of those
};

}  // namespace obliq
