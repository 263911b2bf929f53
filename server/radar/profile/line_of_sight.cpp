#include "server/radar/profile/line_of_sight.h"

#include <algorithm>

#include "server/scene/tolerances.h"

namespace obliq {

void LineOfSight::cut_roofs(double from_m) {
  std::erase_if(spans_, [&](const RoofSpan& span) { return span.far_m <= from_m; });
  for (const RoofSpan& span : spans_) walk_.reach(span.far_m);
  steps_ = disjoint_roofs(spans_);
  std::erase_if(steps_, [](const RoofSpan& step) { return !(step.near_m < step.far_m); });
  step_ = 0;
  while (step_ < steps_.size() && steps_[step_].far_m <= from_m) ++step_;
  next_wall_ = step_ < steps_.size() && steps_[step_].near_m < from_m ? step_ + 1 : step_;
}

bool LineOfSight::covers(const RoofSpan& span) const {
  return std::any_of(spans_.begin(), spans_.end(), [&](const RoofSpan& other) {
    return other.building != span.building && other.roof_y_m >= span.roof_y_m &&
           other.near_m <= span.near_m + kTouching_m && other.far_m >= span.far_m - kTouching_m;
  });
}

void LineOfSight::raise_by_roofs(Horizon<double>& horizon, const RoofSpan& before) const {
  for (const RoofSpan& other : spans_) {
    if (other.building == before.building || !(other.near_m < before.near_m)) continue;
    const double height = other.roof_y_m - antenna_m_.y;
    horizon.raise(other.near_m, height, true);
    horizon.raise(std::min(other.far_m, before.near_m), height, true);
  }
}

}  // namespace obliq
