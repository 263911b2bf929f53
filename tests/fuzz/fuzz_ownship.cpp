// A simulator's datagrams: poses of obliq's own, Entity State PDUs and orders of DIS. Any bytes are a pose
// within its limits, or none.
#include <cmath>

#include "server/apps/dis/ownship.h"
#include "tests/fuzz/input.h"

namespace obliq {
namespace {

void check(const OwnshipPose& pose) {
  bool fits = std::abs(pose.latitude_deg) <= 90 && std::abs(pose.longitude_deg) <= 180 &&
              std::isfinite(pose.height_m) && std::abs(pose.heading_deg) <= 360;
  if (pose.velocity_m_s)
    for (const double part : *pose.velocity_m_s) fits &= std::abs(part) <= 20001;  // 20 km/s, and rounding
  if (pose.attitude)
    fits &= std::abs(pose.attitude->roll_deg) <= 60 && std::abs(pose.attitude->pitch_deg) <= 60;
  if (!fits) fuzz::broken("a pose outside its limits");
}

void run(std::span<const std::byte> bytes) {
  const auto pose = read_pose_datagram(bytes);
  if (const auto* found = std::get_if<OwnshipPose>(&pose)) check(*found);
  const auto state = read_pdu(bytes);
  if (const auto* order = std::get_if<SimulationOrder>(&state)) (void)is_for(order->receiver, {1, 2, 3});
  if (const auto* found = std::get_if<EntityState>(&state))
    for (const double after_s : {0.0, 0.1, 12.0}) check(dead_reckoned(*found, after_s));
}

}  // namespace
}  // namespace obliq

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  obliq::run(std::as_bytes(std::span(data, size)));
  return 0;
}
