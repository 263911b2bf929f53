#include "server/radar/air_view.h"

#include "server/radar/frame_plan.h"

namespace obliq {

AirView air_view(const FramePlan& plan) {
  return {plan.scene().world().frame.geodetic_from_world(plan.pose().antenna).height_m,
          plan.extent().median_height_m, plan.antenna_gain().tilt_rad()};
}

}  // namespace obliq
