#pragma once
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/geometry/sector.h"
#include "server/radar/rays/packets.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/simd/exact_math.h"

namespace obliq {

/// A column of the polar frustum's pixels: one vertical plane.
struct PolarColumn {
  int index;
  int azimuth_bin;
  SinCos offset;  ///< of its bearing from the sector's centre
};

/// Those of some azimuth bins, in order of bearing: column c belongs to the bin of its centre.
std::vector<PolarColumn> polar_columns(const FramePlan& plan, AzimuthRange range);

/// Polar frustum: columns uniform in azimuth, rows from polar_rows.h.
class PolarRays : public RaySource {
 public:
  PolarRays(const FramePlan& plan, AzimuthRange range);
  bool generate(RayBatch& batch) override;

 private:
  struct Row {
    std::uint32_t first_pixel = 0;
    SinCos elevation{0, 1};
    double solid_angle_sr = 0;
  };

  bool add_rows(RayBatch& batch);
  bool begin_row(Row& row, std::size_t number) const;
  void add_row(RayBatch& batch, const Row& row, std::size_t from, std::size_t to, bool backwards) const;

  const FramePlan& plan_;
  SwathTest swath_;
  std::vector<PolarColumn> columns_;
  double width_rad_;
  std::size_t row_ = 0;
  std::size_t taken_ = 0;  // of the row's columns
};

}  // namespace obliq
