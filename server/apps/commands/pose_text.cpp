#include "server/apps/commands/pose_text.h"

#include <fmt/core.h>

#include <cmath>

#include "proto/obliq.pb.h"

namespace obliq {

std::string pose_text(const wire::Pose& pose) {
  return fmt::format("{:.7f} {}, {:.7f} {}, {:.2f} m above {}, bearing {:.3f} degrees",
                     std::abs(pose.latitude_deg()), pose.latitude_deg() < 0 ? 'S' : 'N',
                     std::abs(pose.longitude_deg()), pose.longitude_deg() < 0 ? 'W' : 'E', pose.height_m(),
                     pose.height_reference() == wire::GROUND      ? "ground"
                     : pose.height_reference() == wire::ELLIPSOID ? "ellipsoid"
                                                                  : "datum",
                     pose.bearing_deg());
}

}  // namespace obliq
