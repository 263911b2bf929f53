#pragma once
#include <array>
#include <vector>

#include "server/radar/batches.h"
#include "server/radar/frame_plan.h"
#include "server/radar/ground_beam.h"

namespace obliq {

/// What rays of one wedge meet first where nothing but ground is in sight, whatever way they lie. Each walks
/// the grid by itself, but only from where the highest ground around its bearing first reaches up to it.
class GroundTrace {
 public:
  GroundTrace(const FramePlan& plan, AzimuthRange range);

  /// As EmbreeTracer::trace, of rays of the wedge, each in the azimuth bin that the batch says.
  void trace(const RayBatch& rays, RoughHit* hits);

 private:
  GroundBeam& beam_of(int azimuth_bin, const glm::dvec3& direction);
  double on_grid_m(double from_m, const glm::dvec3& direction) const;

  const FramePlan& plan_;
  int first_bin_;
  std::size_t beams_a_bin_;
  std::vector<SinCos> edges_;  // left edges of the beams
  std::vector<GroundBeam> beams_;
  std::array<double, kBatch> from_m_;
  std::array<double, kBatch> range_m_;
};

}  // namespace obliq
