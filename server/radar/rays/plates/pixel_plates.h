#pragma once
#include "server/radar/profile/local_sight.h"
#include "server/radar/rays/plates/buildings_by_bearing.h"
#include "server/radar/rays/plates/plate_source.h"

namespace obliq {

class WedgeVisibility;  // server/radar/visibility/wedge_visibility.h

/// Plates of the symmetric and the oblique frustum. Neighbouring pixels lie in different vertical planes, so
/// each plate is walked on its own: from its hit outwards and inwards to the pixel's edges, as they lie in
/// the ray's plane. What stands far in front is not met by so short a walk; no light goes to range bins that
/// the profiles of the azimuth bin call hidden.
class PixelPlates : public PlateSpreader {
 public:
  PixelPlates(const FramePlan& plan, AzimuthRange range, WedgeVisibility& profile);
  void take(const RayBatch& rays, std::size_t k, const ExactHit* hit, std::vector<Sample>& samples) override;
  void finish(std::vector<Sample>&) override {}

 private:
  double half_extent(std::uint32_t pixel) const;

  const FramePlan& plan_;
  AzimuthRange range_;
  WedgeVisibility& profile_;
  std::vector<BuildingFan> fans_;  // [range.count]
  LocalSurface surface_;
  std::vector<RoofSpan> roofs_;
  std::vector<SurfaceSegment> visible_;
  Plate plate_;
  double sin_pitch_ = 1;
  double cos_pitch_ = 0;
};

}  // namespace obliq
