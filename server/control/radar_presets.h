#pragma once
// radar.preset: one word for a whole radar.
#include <span>
#include <string_view>

#include "server/control/config_tree.h"
#include "server/control/key.h"

namespace obliq {

/// A file of server/control/presets: the keys of [radar] and its sections at the top of a scene file, each
/// with its source or "assumed" in a comment.
struct RadarPreset {
  std::string_view name;
  std::string_view text;
};

/// In the order of their names.
std::span<const RadarPreset> radar_presets();

/// The preset of that name, or null.
const RadarPreset* find_radar_preset(std::string_view name);

/// The names of all presets.
std::span<const Choice> radar_preset_choices();

/// What the preset is: the line of words that its file begins with.
std::string_view first_sentence(const RadarPreset& preset);

/// As a scene file's tree; places are "preset NAME:LINE".
ConfigNode preset_tree(const RadarPreset& preset);

}  // namespace obliq
