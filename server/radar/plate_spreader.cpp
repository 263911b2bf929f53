#include "server/radar/plate_spreader.h"

#include "server/radar/column_plates.h"
#include "server/radar/pixel_plates.h"

namespace obliq {

std::unique_ptr<PlateSpreader> make_plate_spreader(const FramePlan& plan, AzimuthRange range,
                                                   WedgeProfile& profile) {
  if (plan.settings().frustum == FrustumKind::polar) return std::make_unique<ColumnPlates>(plan);
  return std::make_unique<PixelPlates>(plan, range, profile);
}

}  // namespace obliq
