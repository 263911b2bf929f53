#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/echo/corners.h"
#include "server/truth/reference.h"
#include "server/truth/strip_integral.h"

namespace obliq {

/// A wall's foot in one vertical plane, with lit ground before it.
struct LitFoot {
  double d_m, h_m;  ///< ground distance, height above the antenna
  double roof_h_m;
  double lit_m;               ///< how far before it the ground is lit without a gap
  double normal_x, normal_z;  ///< the wall's: unit, towards the antenna
  std::int32_t building;
  std::uint8_t material;
};

/// Integrates what walls and the ground before them return together: the antenna's image in the wall lights
/// the ground before the foot over the wall's height, in steps of at most step_m. Immutable; world and view
/// must outlive it.
class CornerIntegral {
 public:
  CornerIntegral(const World& world, const std::vector<Material>& materials, const ReferenceView& view,
                 double step_m);

  /// Appends the share of the range bin that the foot lies in; nothing outside the swath.
  void add(const LitFoot& foot, double bearing_rad, double width_rad, std::vector<BinShare>& shares) const;

 private:
  double cross_section_per_rad(const LitFoot& foot, double bearing_rad) const;

  const World& world_;
  CornerTable table_;
  const ReferenceView& view_;
  double range_constant_;  // K
  double step_m_;
};

}  // namespace obliq
