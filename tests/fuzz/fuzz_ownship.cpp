// A simulator's datagrams: poses of obliq's own, Entity State PDUs and orders of DIS. Any bytes are a pose
// within its limits, or none.
#include <cmath>

#include "proto/obliq.pb.h"
#include "server/apps/dis/entity_target.h"
#include "server/apps/dis/ownship.h"
#include "server/control/target_message.h"
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

/// As a target of the world, between its PDUs.
void check(const EntityState& state) {
  static EntityKinds kinds({}, {});
  EntityTable table({});
  const EntityTable::Time start{std::chrono::hours(1)};
  table.take(state, start, start);
  for (const int after_s : {0, 5, 11}) {
    for (const EntityTable::Moving& entity : table.changes(start + std::chrono::seconds(after_s), {}).set) {
      const EntityKinds::Match kind = kinds.of(state.type);
      wire::Target target;
      if (kind.type == nullptr || !write_target(entity, kind, {}, target)) continue;
      TargetConfig config;
      if (!merge_message(target, {}, config).empty()) fuzz::broken("a target outside its limits");
    }
  }
}

void run(std::span<const std::byte> bytes) {
  const auto pose = read_pose_datagram(bytes);
  if (const auto* found = std::get_if<OwnshipPose>(&pose)) check(*found);
  const auto state = read_pdu(bytes);
  if (const auto* order = std::get_if<SimulationOrder>(&state)) (void)is_for(order->receiver, {1, 2, 3});
  if (const auto* found = std::get_if<EntityState>(&state))
    for (const double after_s : {0.0, 0.1, 12.0}) check(dead_reckoned(*found, after_s));
  if (const auto* found = std::get_if<EntityState>(&state)) check(*found);
  for (std::span<const std::byte> rest = bytes; !rest.empty();) (void)take_pdu(rest);
}

}  // namespace
}  // namespace obliq

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  obliq::run(std::as_bytes(std::span(data, size)));
  return 0;
}
