#pragma once
#include "server/radar/profile/local_sight.h"
#include "server/radar/rays/plates/buildings_by_bearing.h"
#include "server/radar/rays/plates/plate.h"
#include "server/radar/simd/ground/ground_plates.h"

namespace obliq {

class WedgeVisibility;  // server/radar/visibility/wedge_visibility.h

/// Spreads the pixels of one wedge over their plates, those whose rays hit something. Neighbouring pixels lie
/// in different vertical planes, so each plate is walked on its own: from its hit outwards and inwards to the
/// pixel's edges, as they lie in the ray's plane. So short a walk misses what stands far in front: no light
/// goes to range bins that the profiles of the azimuth bin call hidden.
///
/// Eight plates over bare ground are walked side by side (simd/ground/ground_plates.h). Those that have a
/// building in them or are left there are walked one by one.
class PixelPlates {
 public:
  PixelPlates(const ScenePlan& plan, AzimuthRange range, WedgeVisibility& profile);
  /// Takes rays of the batch from number `first` on, until about a batch of samples is there, and returns the
  /// first one that it has not taken; batches come as PerspectiveRays generates them. Samples go to the batch
  /// or, where a pixel may have any number of them, to those that wait.
  int spread(const RayBatch& rays, const HitBatch& hits, int first, SampleBatch& samples,
             std::vector<Sample>& waiting);

 private:
  const BuildingsByBearing& buildings(const RayBatch& rays, std::size_t k) const {
    return buildings_[static_cast<std::size_t>(rays.azimuth_bin[k] - range_.first)];
  }
  void spread_eight(const RayBatch& rays, const HitBatch& hits, int first, SampleBatch& samples,
                    std::vector<Sample>& waiting);
  void walk(const RayBatch& rays, const HitBatch& hits, std::size_t k, std::vector<Sample>& waiting);

  const ScenePlan& plan_;
  AzimuthRange range_;
  WedgeVisibility& profile_;
  std::vector<BuildingsByBearing> buildings_;  // [range.count]
  PlateField field_;
  GroundPlates plates_;  // of the eight current rays
  LocalSurface surface_;
  std::vector<RoofSpan> roofs_;
  std::vector<SurfaceSegment> visible_;
  Plate plate_;
};

}  // namespace obliq
