#pragma once
#include <chrono>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "server/apps/dis/dead_reckoning.h"
#include "server/apps/dis/entity_state.h"

namespace obliq {

/// The entities of an exercise as their PDUs say, and what of them the server must hear. Knows no sockets and
/// no messages; every moment is its caller's.
class EntityTable {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  struct Options {
    std::optional<EntityId> ownship{};  ///< is no target
    /// Without a PDU for so long an entity has gone. Empty: 2.4 heartbeats, IEEE 1278.1-2012, 4.2.8: 12 s,
    /// and of one that stands (HBT_STATIONARY, 60 s) 144 s.
    std::optional<double> timeout_s{};
    double refresh_hz = 5;     ///< of those on curves, which place, velocity and acceleration cannot follow
    std::size_t most = 10000;  ///< of targets: those nearest to the centre
  };

  /// An entity at the moment asked for.
  struct Moving {
    EntityState state;
    EntityMotion motion;
  };
  struct Changes {
    std::vector<Moving> set;
    std::vector<EntityId> gone;
    bool empty() const { return set.empty() && gone.empty(); }
  };

  explicit EntityTable(const Options& options) : options_(options) {}

  /// A PDU that came at `arrived` and says how it was at `stamped`. One that another has overtaken by less
  /// than a second changes nothing.
  void take(const EntityState& state, Time stamped, Time arrived);
  void remove(const EntityId& id);
  /// Remove Entity; Stop/Freeze: it stands where it is, does not time out, and so do those that are first
  /// heard of meanwhile; Start/Resume: it goes on from there.
  void obey(const SimulationOrder& order, Time now);

  /// What has changed since the last call, with those that are to be sent anew; counts as sent. centre_m: to
  /// which entities are near where there are too many.
  Changes changes(Time now, const std::optional<glm::dvec3>& centre_m);
  /// The server may know nothing of before.
  void forget_sent();

  std::size_t size() const { return entities_.size(); }
  /// As of the last changes().
  std::size_t left_out() const { return left_out_; }
  std::uint64_t overtaken() const { return overtaken_; }
  /// PDUs of entities that are more than can be kept.
  std::uint64_t refused() const { return refused_; }

 private:
  struct Entity {
    EntityState state;
    Time stamped, arrived;
    std::optional<Time> stopped;
    std::optional<Time> sent;  ///< the server has it
    bool changed = true;
    bool left_out = false;
  };
  using All = std::map<EntityId, Entity>;

  All::iterator erase(All::iterator at);
  bool is_timed_out(const Entity& entity, Time now) const;
  bool is_due(const Entity& entity, Time now) const;
  void choose_nearest(Time now, const std::optional<glm::dvec3>& centre_m);
  static EntityMotion motion_of(const Entity& entity, Time now);

  Options options_;
  All entities_;
  std::vector<EntityId> stops_;  ///< receivers that are stopped
  std::set<EntityId> gone_;      ///< and not told yet
  std::size_t left_out_ = 0;
  Time next_choice_{};
  std::uint64_t overtaken_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace obliq
