#pragma once
#include "server/radar/geometry/perspective_frustum.h"

namespace obliq {

/// Slant-range difference between the centre column's outermost pixel edges, far and near, over level ground
/// `below_m` under the antenna: the paper's eqs. (20), (21) for the symmetric and (29), (30) for the oblique
/// frustum, in the corrected forms of design section 2. Metres.
struct StepSizes {
  double far_m = 0;
  double near_m = 0;
};

StepSizes slant_range_steps(const PerspectiveFrustum& frustum, double below_m);

/// The paper's simplification: flat ground, no sector, r_min and r_max at the centre column.
StepSizes flat_steps(FrustumKind kind, double height_m, double r_min_m, double r_max_m, int pixels);

}  // namespace obliq
