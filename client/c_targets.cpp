// Targets of the world by c.h.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "client/c.h"
#include "client/client.h"
#include "proto/obliq.pb.h"
#include "proto/target_record.h"
#include "proto/utf8.h"
// After the messages:
#include "client/c_client.h"

namespace obliq::client::c {

static_assert(static_cast<int>(wire::DATUM) == OBLIQ_DATUM &&
              static_cast<int>(wire::GROUND) == OBLIQ_GROUND &&
              static_cast<int>(wire::ELLIPSOID) == OBLIQ_ELLIPSOID);
static_assert(static_cast<int>(wire::HiddenBy::unknown_ground) == OBLIQ_HIDDEN_BY_UNKNOWN_GROUND &&
              static_cast<int>(wire::HiddenBy::ground) == OBLIQ_HIDDEN_BY_GROUND);

namespace {

/// Of a number that leaves a choice as it is.
constexpr int kAsItIs = -1;

void write(const obliq_route& from, wire::TargetRoute& to) {
  if (from.n == 0) return;
  const auto n = static_cast<int>(from.n);
  to.mutable_latitude_deg()->Add(from.latitude_deg, from.latitude_deg + n);
  to.mutable_longitude_deg()->Add(from.longitude_deg, from.longitude_deg + n);
  to.mutable_speed_m_s()->Add(from.speed_m_s, from.speed_m_s + n);
  if (from.height_m != nullptr) to.mutable_height_m()->Add(from.height_m, from.height_m + n);
  to.set_loops(from.loops != 0);
}

void write(const obliq_target& from, wire::Target& to) {
  to.set_id(from.id);
  if (from.name != nullptr) to.set_name(from.name);
  if (from.type != nullptr) to.set_type(from.type);
  if (!std::isnan(from.latitude_deg)) to.set_latitude_deg(from.latitude_deg);
  if (!std::isnan(from.longitude_deg)) to.set_longitude_deg(from.longitude_deg);
  if (!std::isnan(from.height_m)) to.set_height_m(from.height_m);
  if (from.height_reference != kAsItIs)
    to.set_height_reference(static_cast<wire::HeightReference>(from.height_reference));
  if (!std::isnan(from.geoid_undulation_m)) to.set_geoid_undulation_m(from.geoid_undulation_m);
  if (!std::isnan(from.velocity_north_m_s)) to.set_velocity_north_m_s(from.velocity_north_m_s);
  if (!std::isnan(from.velocity_east_m_s)) to.set_velocity_east_m_s(from.velocity_east_m_s);
  if (!std::isnan(from.velocity_up_m_s)) to.set_velocity_up_m_s(from.velocity_up_m_s);
  if (!std::isnan(from.acceleration_north_m_s2)) to.set_acceleration_north_m_s2(from.acceleration_north_m_s2);
  if (!std::isnan(from.acceleration_east_m_s2)) to.set_acceleration_east_m_s2(from.acceleration_east_m_s2);
  if (!std::isnan(from.acceleration_up_m_s2)) to.set_acceleration_up_m_s2(from.acceleration_up_m_s2);
  if (!std::isnan(from.heading_deg)) to.set_heading_deg(from.heading_deg);
  if (!std::isnan(from.heading_rate_deg_s)) to.set_heading_rate_deg_s(from.heading_rate_deg_s);
  if (!std::isnan(from.rcs_dbsm)) to.set_rcs_dbsm(from.rcs_dbsm);
  if (from.swerling != kAsItIs) to.set_swerling(from.swerling);
  if (!std::isnan(from.length_m)) to.set_length_m(from.length_m);
  if (!std::isnan(from.width_m)) to.set_width_m(from.width_m);
  if (!std::isnan(from.top_m)) to.set_top_m(from.top_m);
  if (from.sim_time_ns != kNoTime) to.set_sim_time_ns(from.sim_time_ns);
  if (!std::isnan(from.age_s)) to.set_age_s(from.age_s);
  if (!std::isnan(from.valid_s)) to.set_valid_s(from.valid_s);
  if (from.route != nullptr) write(*from.route, *to.mutable_route());
}

constexpr std::size_t kMost = std::numeric_limits<int>::max();  // of a message's list

std::string in_target(std::size_t k, const char* field) {
  return "targets[" + std::to_string(k) + "]." + field;
}

/// What no message can hold. The rest the server checks.
Status fault_of(std::size_t k, const obliq_target& target) {
  if (const auto at = wire::utf8_fault(text_of(target.name)))
    return bad(in_target(k, "name: found no UTF-8 at byte ") + std::to_string(*at) + "; allowed: UTF-8");
  if (const auto at = wire::utf8_fault(text_of(target.type)))
    return bad(in_target(k, "type: found no UTF-8 at byte ") + std::to_string(*at) + "; allowed: UTF-8");
  const obliq_route* route = target.route;
  if (route == nullptr || route->n == 0) return {};
  if (route->n > kMost)
    return bad(in_target(k, "route.n: found ") + std::to_string(route->n) + "; allowed: fewer");
  if (route->latitude_deg == nullptr)
    return bad(in_target(k, "route.latitude_deg: found NULL; allowed: n values"));
  if (route->longitude_deg == nullptr)
    return bad(in_target(k, "route.longitude_deg: found NULL; allowed: n values"));
  if (route->speed_m_s == nullptr) return bad(in_target(k, "route.speed_m_s: found NULL; allowed: n values"));
  return {};
}

/// The server lists a route with a height and a speed for each point.
obliq_route read(const wire::TargetRoute& from) {
  const auto n = static_cast<std::size_t>(
      std::min({from.latitude_deg_size(), from.longitude_deg_size(), from.speed_m_s_size()}));
  const bool has_heights = static_cast<std::size_t>(from.height_m_size()) == n;
  return {n,
          from.latitude_deg().data(),
          from.longitude_deg().data(),
          has_heights ? from.height_m().data() : nullptr,
          from.speed_m_s().data(),
          from.loops()};
}

/// What from lacks stays as obliq_no_target() has it. Texts and the route lie in from and in route.
void read(const wire::Target& from, obliq_target& to, obliq_route& route) {
  obliq_no_target(&to);
  to.id = from.id();
  if (from.has_name()) to.name = from.name().c_str();
  if (from.has_type()) to.type = from.type().c_str();
  if (from.has_latitude_deg()) to.latitude_deg = from.latitude_deg();
  if (from.has_longitude_deg()) to.longitude_deg = from.longitude_deg();
  if (from.has_height_m()) to.height_m = from.height_m();
  if (from.has_height_reference()) to.height_reference = static_cast<int>(from.height_reference());
  if (from.has_geoid_undulation_m()) to.geoid_undulation_m = from.geoid_undulation_m();
  if (from.has_velocity_north_m_s()) to.velocity_north_m_s = from.velocity_north_m_s();
  if (from.has_velocity_east_m_s()) to.velocity_east_m_s = from.velocity_east_m_s();
  if (from.has_velocity_up_m_s()) to.velocity_up_m_s = from.velocity_up_m_s();
  if (from.has_acceleration_north_m_s2()) to.acceleration_north_m_s2 = from.acceleration_north_m_s2();
  if (from.has_acceleration_east_m_s2()) to.acceleration_east_m_s2 = from.acceleration_east_m_s2();
  if (from.has_acceleration_up_m_s2()) to.acceleration_up_m_s2 = from.acceleration_up_m_s2();
  if (from.has_heading_deg()) to.heading_deg = from.heading_deg();
  if (from.has_heading_rate_deg_s()) to.heading_rate_deg_s = from.heading_rate_deg_s();
  if (from.has_rcs_dbsm()) to.rcs_dbsm = from.rcs_dbsm();
  if (from.has_swerling()) to.swerling = from.swerling();
  if (from.has_length_m()) to.length_m = from.length_m();
  if (from.has_width_m()) to.width_m = from.width_m();
  if (from.has_top_m()) to.top_m = from.top_m();
  if (from.has_sim_time_ns()) to.sim_time_ns = from.sim_time_ns();
  if (from.has_age_s()) to.age_s = from.age_s();
  if (from.has_valid_s()) to.valid_s = from.valid_s();
  if (!from.has_route()) return;
  route = read(from.route());
  to.route = &route;
}

}  // namespace

void read_truth(obliq_client& self) {
  self.truth.clear();
  for (const wire::TargetRecord& record : self.shown.targets) {
    obliq_truth truth;
    truth.id = record.id;
    truth.latitude_deg = record.latitude_deg;
    truth.longitude_deg = record.longitude_deg;
    truth.height_m = record.height_m;
    truth.bearing_deg = record.bearing_deg;
    truth.range_m = record.range_m;
    truth.elevation_deg = static_cast<double>(record.elevation_deg);
    truth.closing_m_s = static_cast<double>(record.closing_m_s);
    truth.snr_db = static_cast<double>(record.snr_db);
    truth.rcs_dbsm = static_cast<double>(record.rcs_dbsm);
    truth.share_seen = static_cast<double>(record.share_seen);
    truth.azimuth_bin = record.azimuth_bin;
    truth.range_bin = record.range_bin;
    truth.hidden_by = static_cast<int>(record.hidden_by);
    truth.is_power = record.is_power;
    self.truth.push_back(truth);
  }
}

}  // namespace obliq::client::c

using namespace obliq;
using namespace obliq::client::c;
using client::Status;

extern "C" {

int obliq_claim_targets(obliq_client* client, int force) {
  return guarded(client, [&] { return client->client.claim_targets(force != 0); });
}
int obliq_release_targets(obliq_client* client) {
  return guarded(client, [&] { return client->client.release_targets(); });
}

void obliq_no_target(obliq_target* target) {
  if (target == nullptr) return;
  *target = {};
  target->height_reference = target->swerling = kAsItIs;
  target->sim_time_ns = kNoTime;
  for (double* value :
       {&target->latitude_deg, &target->longitude_deg, &target->height_m, &target->geoid_undulation_m,
        &target->velocity_north_m_s, &target->velocity_east_m_s, &target->velocity_up_m_s,
        &target->acceleration_north_m_s2, &target->acceleration_east_m_s2, &target->acceleration_up_m_s2,
        &target->heading_deg, &target->heading_rate_deg_s, &target->rcs_dbsm, &target->length_m,
        &target->width_m, &target->top_m, &target->age_s, &target->valid_s})
    *value = kNone;
}

int obliq_set_targets(obliq_client* client, size_t n, const obliq_target* targets, int clear) {
  return guarded(client, [&] {
    if (n > 0 && targets == nullptr) return bad("targets: found NULL; allowed: n targets");
    if (n > kMost) return bad("n: found " + std::to_string(n) + "; allowed: fewer");
    wire::SetTargets change;
    change.set_clear(clear != 0);
    for (std::size_t k = 0; k < n; ++k) {
      if (Status status = fault_of(k, targets[k]); !status.ok()) return status;
      write(targets[k], *change.add_targets());
    }
    return client->client.set_targets(change, client->warnings);
  });
}

int obliq_remove_targets(obliq_client* client, size_t n, const uint64_t* ids) {
  return guarded(client, [&] {
    if (n > 0 && ids == nullptr) return bad("ids: found NULL; allowed: n ids");
    if (n > kMost) return bad("n: found " + std::to_string(n) + "; allowed: fewer");
    wire::SetTargets change;
    change.mutable_gone()->Add(ids, ids + n);
    return client->client.set_targets(change, client->warnings);
  });
}

int obliq_next_target(obliq_client* client, uint64_t after, obliq_target* target) {
  return guarded(client, [&] {
    if (target == nullptr) return bad("target: found NULL; allowed: a place for one");
    if (after == 0)
      if (Status status = client->client.get_targets(client->targets); !status.ok()) return status;
    const auto& all = client->targets.targets();
    const auto found =
        std::ranges::upper_bound(all, after, {}, [](const wire::Target& each) { return each.id(); });
    if (found == all.end())
      obliq_no_target(target);
    else
      read(*found, *target, client->route);
    return Status{};
  });
}

}  // extern "C"
