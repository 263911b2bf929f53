#include "server/apps/dis/entity_table.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

namespace obliq {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr double kMovingTimeout_s = 12;
constexpr double kStandingTimeout_s = 144;
constexpr Seconds kReordered{1};
/// All are sent again within this: targets are valid for three times as long.
constexpr Seconds kRenewal{4};
constexpr std::chrono::seconds kChoicePause{1};
/// Ids are any bytes that come.
constexpr std::size_t kMostEntities = 100'000;
constexpr std::size_t kMostStops = 1000;

}  // namespace

void EntityTable::take(const EntityState& state, Time stamped, Time arrived) {
  if (options_.ownship && state.id == *options_.ownship) return;
  if (!state.active) return remove(state.id);
  const auto known = entities_.find(state.id);
  if (known == entities_.end()) {
    if (entities_.size() >= kMostEntities) {
      ++refused_;
      return;
    }
    gone_.erase(state.id);
    Entity fresh{state, stamped, arrived, {}, {}};
    // Where as many as may be are in the world, the next choice decides.
    fresh.left_out = entities_.size() - left_out_ >= options_.most;
    left_out_ += fresh.left_out ? 1 : 0;
    if (std::ranges::any_of(stops_, [&](const EntityId& receiver) { return is_for(receiver, state.id); }))
      fresh.stopped = stamped;
    entities_.emplace(state.id, std::move(fresh));
    return;
  }
  Entity& entity = known->second;
  entity.arrived = arrived;
  if (stamped < entity.stamped && entity.stamped - stamped < kReordered) {
    ++overtaken_;
    return;
  }
  entity.state = state;
  entity.stamped = stamped;
  if (entity.stopped) entity.stopped = stamped;
  entity.changed = true;
}

void EntityTable::remove(const EntityId& id) {
  if (const auto known = entities_.find(id); known != entities_.end()) erase(known);
}

EntityTable::All::iterator EntityTable::erase(All::iterator at) {
  if (at->second.left_out) --left_out_;
  if (at->second.sent) gone_.insert(at->first);
  return entities_.erase(at);
}

void EntityTable::obey(const SimulationOrder& order, Time now) {
  using What = SimulationOrder::What;
  for (auto at = entities_.begin(); at != entities_.end();) {
    Entity& entity = at->second;
    if (!is_for(order.receiver, at->first)) {
      ++at;
    } else if (order.what == What::remove) {
      at = erase(at);
    } else {
      if (order.what == What::stop && !entity.stopped) {
        entity.stopped = now;
        entity.changed = true;
      } else if (order.what == What::go_on && entity.stopped) {
        entity.stamped += now - *std::exchange(entity.stopped, std::nullopt);
        entity.arrived = now;
        entity.changed = true;
      }
      ++at;
    }
  }
  if (order.what == What::go_on) {
    std::erase_if(stops_, [&](const EntityId& stopped) { return is_for(order.receiver, stopped); });
  } else if (order.what == What::stop && stops_.size() < kMostStops &&
             std::ranges::find(stops_, order.receiver) == stops_.end()) {
    stops_.push_back(order.receiver);
  }
}

EntityMotion EntityTable::motion_of(const Entity& entity, Time now) {
  if (!entity.stopped) return reckoned(entity.state, Seconds(now - entity.stamped).count());
  EntityMotion motion = reckoned(entity.state, Seconds(*entity.stopped - entity.stamped).count());
  motion.velocity_m_s = motion.acceleration_m_s2 = motion.turn_rad_s = glm::dvec3(0.0);
  return motion;
}

bool EntityTable::is_timed_out(const Entity& entity, Time now) const {
  if (entity.stopped) return false;
  const double usual_s = stands(entity.state) ? kStandingTimeout_s : kMovingTimeout_s;
  return Seconds(now - entity.arrived).count() > options_.timeout_s.value_or(usual_s);
}

bool EntityTable::is_due(const Entity& entity, Time now) const {
  if (entity.left_out) return false;
  if (entity.changed || !entity.sent) return true;
  const Seconds age = now - *entity.sent;
  if (age >= kRenewal) return true;
  return options_.refresh_hz > 0 && !entity.stopped && is_curved(entity.state) &&
         age.count() * options_.refresh_hz >= 1;
}

void EntityTable::choose_nearest(Time now, const std::optional<glm::dvec3>& centre_m) {
  next_choice_ = now + kChoicePause;
  std::vector<std::pair<double, Entity*>> by_distance;
  for (auto& [id, entity] : entities_)
    by_distance.emplace_back(
        centre_m ? glm::distance(motion_of(entity, now).location_m, *centre_m) : (entity.left_out ? 1 : 0),
        &entity);
  const std::size_t kept = std::min(options_.most, by_distance.size());
  const auto end = by_distance.begin() + static_cast<std::ptrdiff_t>(kept);
  if (end != by_distance.end())
    std::ranges::nth_element(by_distance, end, {}, [](const auto& entry) { return entry.first; });
  left_out_ = by_distance.size() - kept;
  for (auto at = by_distance.begin(); at != by_distance.end(); ++at) {
    Entity& entity = *at->second;
    entity.left_out = at >= end;
    if (entity.left_out && std::exchange(entity.sent, std::nullopt)) gone_.insert(entity.state.id);
  }
}

EntityTable::Changes EntityTable::changes(Time now, const std::optional<glm::dvec3>& centre_m) {
  for (auto at = entities_.begin(); at != entities_.end();)
    at = is_timed_out(at->second, now) ? erase(at) : std::next(at);
  if ((entities_.size() > options_.most || left_out_ > 0) && now >= next_choice_)
    choose_nearest(now, centre_m);
  Changes changes;
  for (auto& [id, entity] : entities_) {
    if (!is_due(entity, now)) continue;
    entity.changed = false;
    entity.sent = now;
    gone_.erase(id);
    changes.set.push_back({entity.state, motion_of(entity, now)});
  }
  changes.gone.assign(gone_.begin(), gone_.end());
  gone_.clear();
  return changes;
}

void EntityTable::forget_sent() {
  gone_.clear();
  for (auto& [id, entity] : entities_) entity.sent.reset();
}

}  // namespace obliq
