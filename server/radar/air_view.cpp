#include "server/radar/air_view.h"

#include "server/radar/scene_plan.h"

namespace obliq {

AirView air_view(const ScenePlan& plan) {
  return {plan.scene().world().frame.geodetic_from_world(plan.pose().antenna).height_m,
          plan.extent().median_height_m, plan.antenna_gain().tilt_rad()};
}

}  // namespace obliq
