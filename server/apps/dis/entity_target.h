#pragma once
#include <cstdint>
#include <optional>

#include "server/apps/dis/entity_kinds.h"
#include "server/apps/dis/entity_table.h"

namespace obliq::wire {
class Target;
}

namespace obliq {

/// Of an entity in the world: stable, never 0, and above the numbers that a scene file's targets have.
std::uint64_t target_id(const EntityId& id);

/// How places of DIS, which are above the ellipsoid, become heights of targets.
struct EntityHeights {
  double undulation_m = 0;  ///< of the geoid, over the ellipsoid
  bool on_ground = false;   ///< land and surface platforms, and persons, stand on the ground as it is loaded
};

/// All of a target but its time and validity, as the entity is at that moment. False where it is outside the
/// limits of a target.
bool write_target(const EntityTable::Moving& entity, const EntityKinds::Match& kind,
                  const EntityHeights& heights, wire::Target& target);

}  // namespace obliq
