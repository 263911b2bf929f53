#pragma once
// A plate is a pixel's footprint: the visible surface that the pixel covers, by range bin. The pixel's solid
// angle is spread over it.
#include <algorithm>
#include <cmath>
#include <vector>

#include "server/radar/profile/local_sight.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/samples.h"
#include "server/radar/scene_plan.h"

namespace obliq {

/// The part of a plate in one range bin and on one surface. Sums weighted with the part's share until
/// Plate::finish.
struct PlatePart {
  int range_bin = 0;  ///< -1: nearer than r_min; n_range: beyond r_max
  std::uint32_t face = kNoFace;
  std::uint8_t material = 0;
  float raster_gamma = 1;
  double share = 0;        ///< difference of the sines of its elevations
  double over_range2 = 0;  ///< 1 / r^2, in 1 / m^2
  double cos_incidence = 0;
  double sin_elevation = 0;
  double d_m = 0;
  double least_range_m = HUGE_VAL;
  double most_range_m = 0;

  /// The range at which the whole part has the power that its surface of constant gamma has.
  double range_m() const { return std::clamp(1 / std::sqrt(over_range2), least_range_m, most_range_m); }
};

/// One pixel's plate while it is put together.
class Plate {
 public:
  void clear() {
    parts_.clear();
    end_ = {};
  }

  /// Adds a visible segment of the pixel's plane, cut at the edges of the range bins. A segment's range need
  /// not be monotone: it is cut at the foot of the antenna's perpendicular too.
  void add(const BinGrid& bins, const SurfaceSegment& segment);

  /// The parts, their shares scaled to add up to `solid_angle_sr`. Empty when nothing was added.
  const std::vector<PlatePart>& finish(double solid_angle_sr);

  /// Leaves out parts in range bins that hold no visible surface; visible[n_range].
  void drop_hidden(const std::vector<std::uint8_t>& visible, int kept_bin);

 private:
  /// A point of the plane as its slant range, its elevation and its range bin.
  struct End {
    double d_m = -1;
    double h_m = 0;
    double range_m = 0;
    double sine = 0;
    int bin = 0;
  };

  End end_at(const BinGrid& bins, double d_m, double h_m) const;
  void add_monotone(const BinGrid& bins, const SurfaceSegment& segment, const End& from, const End& to);
  void add_part(int bin, const SurfaceSegment& segment, const End& from, const End& to);

  End end_;  // where the last segment ended: mostly the next one begins there
  std::vector<PlatePart> parts_;
};

/// Appends the samples of a pixel, in the vertical plane of a bearing; they share the solid angle of
/// `nearest`, the pixel as one sample. That is its only sample when the plate has no part.
void emit_plate(const ScenePlan& plan, Plate& plate, const Sample& nearest, double sin_bearing,
                double cos_bearing, std::vector<Sample>& samples);

}  // namespace obliq
