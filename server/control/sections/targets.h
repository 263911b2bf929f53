#pragma once
// [target_types.NAME] and [[target]]: vehicles, ships and aircraft.
#include <span>
#include <string>
#include <vector>

#include "server/control/row.h"
#include "server/control/sections/section.h"
#include "server/control/sections/target_config.h"

namespace obliq {

struct ConfigNode;
struct SceneConfig;
struct SceneReading;
struct Section;
template <class T>
struct SpecialKey;

extern const Section kTargetsSection;

Keys<TargetType> target_type_keys();
std::span<const Row<Target>> target_rows();
/// Its value comes from the table of the target's type: one of the target's own would take that table's
/// place.
bool is_from_aspects(const Key& key, const Target& target);
std::span<const Row<TargetConfig>> target_config_rows();
std::span<const Row<RoutePoint>> route_rows();

void read_target_types(SceneReading& scene);
/// Of a file that has tables [target_types.NAME] alone: rising by name. Throws InputError.
std::vector<TargetType> read_type_file(const ConfigNode& root);
/// After their types.
void read_targets(SceneReading& scene);
std::string printed_targets(const SceneConfig& config);

/// What is rendered of them; null: none.
TargetsPtr targets_of(const SceneConfig& config);

}  // namespace obliq
