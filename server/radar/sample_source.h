#pragma once
#include <memory>

#include "server/radar/batches.h"
#include "server/radar/bins.h"
#include "server/radar/frame_plan.h"
#include "server/radar/sample_tap.h"

namespace obliq {

/// Finds the visible pieces of surface of one wedge, batch by batch, in a fixed order. What comes after knows
/// nothing of rays, pixels or planes.
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// Fills the batch (possibly with nothing) and counts what it took; false when nothing was left to look at.
  /// Looks at a bounded part at a time, because a rendering pauses only between batches.
  virtual bool next(SampleBatch& samples, FrameStats& stats) = 0;
};

/// Whether frames may need scene.tracer(): all rays do, or those that come near buildings and do not lie in
/// vertical planes, which are marched.
bool needs_tracer(const Scene& scene, FrustumKind frustum);

class WedgeProfile;  // server/radar/wedge_profile.h

/// Samples of azimuth bins [range.first, range.first + range.count), the way the plan's frustum looks. `tap`
/// may be null. So may `profile`, of the same azimuth bins: whoever needs it too hands it in, so that nothing
/// is marched twice. All of them must outlive the source.
std::unique_ptr<SampleSource> make_sample_source(const FramePlan& plan, AzimuthRange range, SampleTap* tap,
                                                 WedgeProfile* profile = nullptr);

}  // namespace obliq
