#pragma once
// [[platform]]: what radars ride on.
#include <string>
#include <vector>

#include "server/control/parameters.h"

namespace obliq {

class SectionReader;
struct SceneConfig;
struct SceneReading;

/// Those of [antenna] that say where it is and how it moves, not where it looks.
std::vector<const Parameter*> platform_parameters();
/// "platform.height_m"
std::string platform_key(const Parameter& parameter);

/// Of a radar that rides: it is its platform's, not its own.
bool is_of_platform(const RadarConfig& radar, const Parameter& parameter);

/// Before the radars.
void read_platforms(SceneReading& scene);
std::string printed_platforms(const SceneConfig& config);

/// A name of a radar or a platform: key is "radar.name" or "platform.name".
void read_name(SectionReader& reader, std::string_view key, std::string& name);

/// Says which platforms carry nothing: a server does not have them.
void note_empty_platforms(SceneConfig& config);

}  // namespace obliq
