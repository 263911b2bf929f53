#pragma once
#include "server/radar/profile/local_sight.h"
#include "server/radar/rays/plates/buildings_by_bearing.h"
#include "server/radar/rays/plates/plate.h"

namespace obliq {

class WedgeVisibility;  // server/radar/visibility/wedge_visibility.h

/// Plates of the symmetric and the oblique frustum. Neighbouring pixels lie in different vertical planes, so
/// each plate is walked on its own: from its hit outwards and inwards to the pixel's edges, as they lie in
/// the ray's plane. So short a walk misses what stands far in front: no light goes to range bins that the
/// profiles of the azimuth bin call hidden.
class PixelPlates : public PlateSource {
 public:
  PixelPlates(const FramePlan& plan, AzimuthRange range, WedgeVisibility& profile);
  void spread(const RayBatch& rays, const HitBatch& hits, std::size_t k,
              std::vector<Sample>& samples) override;
  void finish(std::vector<Sample>&) override {}

 private:
  double half_extent(std::uint32_t pixel) const;

  const FramePlan& plan_;
  AzimuthRange range_;
  WedgeVisibility& profile_;
  std::vector<BuildingsByBearing> buildings_;  // [range.count]
  LocalSurface surface_;
  std::vector<RoofSpan> roofs_;
  std::vector<SurfaceSegment> visible_;
  Plate plate_;
  double sin_pitch_ = 1;
  double cos_pitch_ = 0;
};

}  // namespace obliq
