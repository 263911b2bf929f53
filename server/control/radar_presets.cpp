#include "server/control/radar_presets.h"

#include <algorithm>
#include <vector>

namespace obliq {

const RadarPreset* find_radar_preset(std::string_view name) {
  const auto found = std::ranges::find(radar_presets(), name, &RadarPreset::name);
  return found != radar_presets().end() ? &*found : nullptr;
}

std::span<const Choice> radar_preset_choices() {
  static const auto choices = [] {
    std::vector<Choice> names;
    for (const RadarPreset& preset : radar_presets()) names.push_back({preset.name});
    return names;
  }();
  return choices;
}

std::string_view first_sentence(const RadarPreset& preset) {
  const std::string_view words = preset.text.substr(2);  // after "# "
  return words.substr(0, words.find_first_of(":,.\n"));
}

ConfigNode preset_tree(const RadarPreset& preset) {
  return parse_config_text(std::string(preset.text), "preset " + std::string(preset.name));
}

}  // namespace obliq
