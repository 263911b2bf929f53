#include "server/control/overrides.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "server/control/key_list.h"
#include "server/control/quality_presets.h"
#include "server/control/sections/radar.h"

namespace obliq {

namespace {

using Kind = ConfigNode::Kind;

constexpr std::string_view kQualityKey = "frustum.quality";

/// frustum.pixels = 512 or [512, 256] becomes pixel_columns and pixel_rows. What is neither stays, and the
/// reader refuses it.
void split_pixels(ConfigNode& holder) {
  ConfigNode* frustum = holder.find("frustum");
  if (frustum == nullptr || frustum->kind != Kind::table) return;
  const ConfigNode* pixels = frustum->find("pixels");
  if (pixels == nullptr || frustum->find("pixel_columns") || frustum->find("pixel_rows")) return;
  std::array<ConfigNode, 2> sides;
  if (pixels->kind == Kind::value) {
    sides = {*pixels, *pixels};
  } else if (pixels->kind == Kind::array && pixels->items.size() == 2) {
    sides = {pixels->items[0], pixels->items[1]};
  } else {
    return;
  }
  sides[0].key = "pixel_columns";
  sides[1].key = "pixel_rows";
  std::erase_if(frustum->items, [](const ConfigNode& n) { return n.key == "pixels"; });
  for (ConfigNode& side : sides) frustum->items.push_back(std::move(side));
}

/// frustum.quality = "draft" becomes the keys that it stands for, where the same table does not name them
/// itself. What is no preset stays, and the reader refuses it.
void expand_quality(ConfigNode& holder) {
  ConfigNode* frustum = holder.find("frustum");
  if (frustum == nullptr || frustum->kind != Kind::table) return;
  const ConfigNode* found = frustum->find("quality");
  const auto* name = found != nullptr ? std::get_if<std::string>(&found->value) : nullptr;
  const QualityPreset* preset = name != nullptr && found->kind == Kind::value ? find_quality(*name) : nullptr;
  if (preset == nullptr) return;
  const ConfigNode quality = *found;
  std::erase_if(frustum->items, [](const ConfigNode& n) { return n.key == "quality"; });
  for (ConfigNode& node : quality_nodes(*preset, quality))
    if (frustum->find(node.key) == nullptr) frustum->items.push_back(std::move(node));
}

/// The short forms of one layer, written out.
void expand_frustum(ConfigNode& holder) {
  split_pixels(holder);
  expand_quality(holder);
}

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

/// Gives every number of pixels that depends on the bins its value, in each radar's own table.
void settle_pixels(ConfigNode& root) {
  struct Side {
    std::string_view pixels;
    std::string_view bins;
    int default_bins;
  };
  const RadarSettings defaults;
  for (const Side& side : {Side{"pixel_columns", "azimuth", defaults.azimuth_bins},
                           Side{"pixel_rows", "range", defaults.range_bins}}) {
    for (ConfigNode* radar : radar_tables(root)) {
      const auto effective = [&](std::string_view section, std::string_view key) -> const ConfigNode* {
        for (const ConfigNode* holder :
             {const_cast<const ConfigNode*>(radar), const_cast<const ConfigNode*>(&root)}) {
          const ConfigNode* table = holder->find(section);
          const ConfigNode* node =
              table != nullptr && table->kind == Kind::table ? table->find(key) : nullptr;
          if (node != nullptr) return node;
        }
        return nullptr;
      };
      const ConfigNode* pixels = effective("frustum", side.pixels);
      if (pixels == nullptr || !(pixels->per_bin > 0)) continue;
      const ConfigNode* bins = effective("bins", side.bins);
      const auto* given = bins != nullptr ? std::get_if<std::int64_t>(&bins->value) : nullptr;
      const int n = given != nullptr ? static_cast<int>(std::clamp<std::int64_t>(*given, 1, 1 << 14))
                                     : side.default_bins;
      ConfigNode settled = *pixels;
      settled.per_bin = 0;
      settled.value = std::int64_t{pixels_for_bins(pixels->per_bin, n)};
      merge(*radar, nest("frustum." + std::string(side.pixels), std::move(settled)));
    }
    // What all radars shared, each has now.
    if (ConfigNode* frustum = root.find("frustum"))
      std::erase_if(frustum->items,
                    [&](const ConfigNode& n) { return n.key == side.pixels && n.per_bin > 0; });
  }
}

/// A radar's own table and what all share, of a section.
std::vector<const ConfigNode*> holders_of(const ConfigNode& radar, const ConfigNode& root,
                                          std::string_view section) {
  std::vector<const ConfigNode*> holders;
  for (const ConfigNode* holder : {&radar, &root})
    if (const ConfigNode* table = holder->find(section)) holders.push_back(table);
  return holders;
}

/// Says which frustum a radar has whose kind nobody named, and gives it one where nothing of it is named at
/// all.
void choose_frustum(ConfigNode& root, std::vector<std::string>& notes) {
  std::vector<std::string> nothing, no_kind;
  const std::vector<ConfigNode*> radars = radar_tables(root);
  for (ConfigNode* radar : radars) {
    bool named = false;
    bool kind = false;
    for (const ConfigNode* frustum : holders_of(*radar, root, "frustum")) {
      named |= frustum->kind != Kind::table || !frustum->items.empty();
      kind |= frustum->find("kind") != nullptr || frustum->find("quality") != nullptr;
    }
    if (named) {
      if (!kind) no_kind.push_back(radar_name(*radar));
      continue;
    }
    nothing.push_back(radar_name(*radar));
    ConfigNode chosen;
    chosen.kind = Kind::value;
    chosen.where = "default";
    for (const ConfigNode& node : quality_nodes(*find_quality(kDefaultQuality), chosen))
      merge(*radar, nest("frustum." + node.key, node));
  }
  const auto note = [&](const std::vector<std::string>& names, const std::string& text) {
    if (names.empty()) return;
    std::string whose;
    if (names.size() < radars.size())
      for (const std::string& name : names) whose += (whose.empty() ? "radar " : ", ") + name;
    notes.push_back(whose + (whose.empty() ? "" : ": ") + text);
  };
  note(nothing, "no frustum named: sweep \"" + std::string(kDefaultQuality) +
                    "\"; frustum.kind = \"oblique\" casts rays with Embree");
  note(no_kind,
       "frustum.kind is not named: \"oblique\", rays cast with Embree; frustum.quality = \"standard\" takes "
       "the sweep");
}

void apply_environment(ConfigNode& root, Complaints& complaints) {
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
    ConfigNode patch = nest(key, parse_config_value(text.substr(equals + 1), "environment " + name));
    expand_frustum(patch);
    lay_over(root, patch, "");
  }
}

void apply_flag(ConfigNode& root, const std::string& flag, Complaints& complaints) {
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
  ConfigNode patch = nest(key, parse_config_value(std::string_view(flag).substr(equals + 1), "--set " + key));
  expand_frustum(patch);
  const std::string_view section = std::string_view(key).substr(0, key.find('.'));
  if (!only_radar.empty() && section != "radar" &&
      std::ranges::find(kRadarTables, section) == kRadarTables.end()) {
    complaints.add("--set", {key, "a key that is no radar parameter behind " + toml_string(only_radar + ":"),
                             "the key alone, since it is the whole scene's"});
    return;
  }
  if (!lay_over(root, patch, only_radar))
    complaints.add("--set", {key, "a radar named " + toml_string(only_radar),
                             "a radar of the scene file and a radar parameter"});
}

}  // namespace

void apply_overrides(ConfigNode& root, const std::vector<std::string>& flags, Complaints& complaints,
                     std::vector<std::string>& notes) {
  expand_frustum(root);
  for (ConfigNode* table : radar_tables(root)) expand_frustum(*table);
  apply_environment(root, complaints);
  std::vector<std::string> ordered = flags;
  std::stable_partition(ordered.begin(), ordered.end(), [](const std::string& flag) {
    return key_of_flag(flag) == kQualityKey;  // first, so that a key of its own wins wherever it stands
  });
  for (const std::string& flag : ordered) apply_flag(root, flag, complaints);
  choose_frustum(root, notes);
  settle_pixels(root);
}

}  // namespace obliq
