#include "proto/obliq.pb.h"
#include "tests/fuzz/make_seeds.h"

namespace obliq::fuzz {

void write_target_requests(const wire::RenderOnce& once) {
  using wire::MessageType;
  wire::ClaimControl of_targets;
  of_targets.add_kinds(wire::TARGETS_CLAIM);
  wire::SetTargets world;
  world.set_request_id(11);
  world.add_gone(3);
  for (const std::uint64_t id : {1U, 2U}) {
    wire::Target& target = *world.add_targets();
    target.set_id(id);
    target.set_latitude_deg(33.02);
    target.set_longitude_deg(-99);
    target.set_velocity_north_m_s(20);
    target.set_valid_s(12);
  }
  world.mutable_targets(1)->clear_velocity_north_m_s();
  world.mutable_targets(1)->mutable_route()->add_latitude_deg(33.03);
  world.mutable_targets(1)->mutable_route()->add_longitude_deg(-99.01);
  world.mutable_targets(1)->mutable_route()->add_speed_m_s(12);
  world.mutable_targets(1)->mutable_route()->set_loops(true);
  wire::RenderOnce of_world = once;
  of_world.set_live_targets(true);
  of_world.set_truth(true);
  *of_world.add_targets() = world.targets(0);
  write_seed("requests", "targets",
             request(MessageType::claim_control, of_targets) + request(MessageType::set_targets, world) +
                 request(MessageType::get_targets, wire::GetTargets{}) +
                 request(MessageType::render_once, of_world) + request(MessageType::release_control, [] {
                   wire::ReleaseControl all;
                   all.add_kinds(wire::TARGETS_CLAIM);
                   return all;
                 }()));
}

}  // namespace obliq::fuzz
