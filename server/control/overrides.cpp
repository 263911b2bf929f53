#include "server/control/overrides.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>

#include "server/control/key_list.h"
#include "server/control/sections/radar.h"

namespace obliq {

namespace {

using Kind = ConfigNode::Kind;

constexpr std::string_view kQualityKey = "frustum.quality";

/// The tables of the radars: [radar], or each [[radar]]. One is made where there is none.
std::vector<ConfigNode*> radar_tables(ConfigNode& root) {
  std::vector<ConfigNode*> tables;
  ConfigNode* radar = root.find("radar");
  if (radar == nullptr) radar = root.table("radar");
  if (radar->kind == Kind::table) tables.push_back(radar);
  if (radar->kind == Kind::array)
    for (ConfigNode& item : radar->items)
      if (item.kind == Kind::table) tables.push_back(&item);
  return tables;
}

std::string radar_name(const ConfigNode& table) {
  const ConfigNode* name = table.find("name");
  const auto* text = name != nullptr ? std::get_if<std::string>(&name->value) : nullptr;
  return text != nullptr ? *text : RadarConfig{}.name;
}

/// Lays a nested patch over the tree. The radar sections go into every radar's own table (or the named
/// one's), where they beat what the file says for all.
bool lay_over(ConfigNode& root, const ConfigNode& patch, const std::string& only_radar) {
  ConfigNode for_radar;
  ConfigNode for_all;
  for (const ConfigNode& section : patch.items) {
    if (section.key == "radar" && section.kind == Kind::table) {
      for (const ConfigNode& item : section.items) for_radar.items.push_back(item);
    } else if (std::ranges::find(kRadarTables, section.key) != kRadarTables.end()) {
      for_radar.items.push_back(section);
    } else {
      for_all.items.push_back(section);
    }
  }
  bool found = false;
  if (!for_radar.items.empty()) {
    for (ConfigNode* table : radar_tables(root)) {
      if (!only_radar.empty() && radar_name(*table) != only_radar) continue;
      merge(*table, for_radar);
      found = true;
    }
  }
  if (only_radar.empty()) merge(root, for_all);
  return found || only_radar.empty();
}

std::string variable_name(std::string_view key) {
  std::string name = "OBLIQ_";
  for (const char c : key)
    name += c == '.' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

/// A flag's key without the radar's name.
std::string key_of_flag(const std::string& flag) {
  const std::string key = flag.substr(0, flag.find('='));
  const std::size_t colon = key.rfind(':');
  return colon == std::string::npos ? key : key.substr(colon + 1);
}

/// The variables of this process, that of the quality first: a key of its own beats it.
std::vector<std::string> environment() {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) variables.emplace_back(*variable);
  const std::string quality = variable_name(kQualityKey) + "=";
  std::stable_partition(variables.begin(), variables.end(),
                        [&](const std::string& text) { return text.starts_with(quality); });
  return variables;
}

void apply_environment(ConfigNode& root, int& layer, Complaints& complaints) {
  const std::vector<std::string> keys = names_of_flags();
  std::vector<std::string> names;
  for (const std::string& key : keys) names.push_back(variable_name(key));
  for (const std::string& variable : environment()) {
    const std::string_view text(variable);
    const std::size_t equals = text.find('=');
    const std::string name(text.substr(0, equals));
    // OBLIQ_ alone is not ours to claim: only names that begin like one of our sections.
    const bool ours = std::ranges::any_of(keys, [&](const std::string& key) {
      return name.starts_with(variable_name(key.substr(0, key.find('.') + 1)));
    });
    if (!ours || equals == std::string_view::npos) continue;
    const auto known = std::ranges::find(names, name);
    if (known == names.end()) {
      const std::string near = nearest_name(name, names);
      complaints.add("environment", {name, "an unknown key",
                                     near.empty() ? "see `obliq parameters`" : "did you mean " + near + "?"});
      continue;
    }
    const std::string& key = keys[static_cast<std::size_t>(known - names.begin())];
    ConfigNode patch = nest(key, parse_config_value(text.substr(equals + 1), "environment " + name, ++layer));
    lay_over(root, patch, "");
  }
}

void apply_flag(ConfigNode& root, const std::string& flag, int layer, Complaints& complaints) {
  const std::size_t equals = flag.find('=');
  std::string key = flag.substr(0, equals);
  const std::size_t colon = key.rfind(':');
  const std::string only_radar = colon == std::string::npos ? "" : key.substr(0, colon);
  if (colon != std::string::npos) key.erase(0, colon + 1);
  const bool has_parts = key.find('.') != std::string::npos && key.front() != '.' && key.back() != '.' &&
                         key.find("..") == std::string::npos && std::ranges::count(key, '.') < 8;
  if (equals == std::string::npos || !has_parts || colon == 0) {
    complaints.add("--set",
                   {toml_string(flag), "no key and value", "KEY=VALUE, such as radar.r_max_m=37000"});
    return;
  }
  ConfigNode patch =
      nest(key, parse_config_value(std::string_view(flag).substr(equals + 1), "--set " + key, layer));
  const std::string_view section = std::string_view(key).substr(0, key.find('.'));
  if (!only_radar.empty() && section != "radar" &&
      std::ranges::find(kRadarTables, section) == kRadarTables.end()) {
    complaints.add("--set", {key, "a key that is no radar parameter behind " + toml_string(only_radar + ":"),
                             "the key alone: it belongs to the whole scene"});
    return;
  }
  if (!lay_over(root, patch, only_radar))
    complaints.add("--set", {key, "a radar named " + toml_string(only_radar),
                             "a radar of the scene file and a radar parameter"});
}

}  // namespace

void apply_overrides(ConfigNode& root, const std::vector<std::string>& flags, Complaints& complaints) {
  radar_tables(root);  // one is made where there is none
  int layer = 0;
  apply_environment(root, layer, complaints);
  std::vector<std::string> ordered = flags;
  std::stable_partition(ordered.begin(), ordered.end(), [](const std::string& flag) {
    return key_of_flag(flag) == kQualityKey;  // first, so that a key of its own wins wherever it stands
  });
  for (const std::string& flag : ordered) apply_flag(root, flag, ++layer, complaints);
}

}  // namespace obliq
