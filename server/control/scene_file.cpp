#include "server/control/scene_file.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>

#include "server/control/key_list.h"
#include "server/control/sections/materials.h"
#include "server/control/sections/platform.h"
#include "server/control/sections/radar.h"
#include "server/control/sections/section.h"
#include "server/control/sections/sources.h"
#include "server/control/sections/targets.h"
#include "terrain/world.h"

namespace obliq {

namespace {

/// Where synthetic ground lies when no antenna says otherwise: the paper's Texas.
constexpr LonLat kSyntheticPlace{-99.5, 33.0};

void place_radars(SceneConfig& config, const std::vector<MissingPosition>& missing) {
  if (missing.empty()) return;
  const bool synthetic = config.world.terrain.synthetic != SyntheticKind::none;
  const LonLat place = synthetic ? kSyntheticPlace : dem_centre(config.world.terrain);
  for (const MissingPosition& m : missing) {
    PoseSettings& pose = config.radars[m.radar].pose;
    if (m.latitude) pose.latitude_deg = place.latitude_deg;
    if (m.longitude) pose.longitude_deg = place.longitude_deg;
  }
}

SceneConfig load(ConfigNode root, const std::filesystem::path& path, const LoadOptions& options) {
  SceneConfig config;
  config.path = path;
  config.name = path.stem().string();

  Complaints complaints;
  apply_overrides(root, options.set, complaints);

  SectionReader top(root, "", complaints);
  SceneReading scene{config, top, complaints, std::filesystem::absolute(path).parent_path()};
  read_sections(scene);
  read_materials(scene);
  read_list(scene, kBuildings);
  read_list(scene, kPrisms);
  read_list(scene, kSurfaces);
  settle_corners(scene);
  mark_used_materials(config);
  read_target_types(scene);
  read_targets(scene);
  read_platforms(scene);
  const std::vector<MissingPosition> missing = read_radars(scene);
  top.finish();
  complaints.throw_if_any();

  place_radars(config, missing);
  set_terrain_reach(config);
  return config;
}

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

/// Tables go into the table of their name, or into each table of a list of that name.
void merge_into_lists(ConfigNode& root, const ConfigNode& patch) {
  for (const ConfigNode& section : patch.items) {
    ConfigNode* list = root.find(section.key);
    const auto is_table = [](const ConfigNode& node) { return node.kind == Kind::table; };
    if (is_table(section) && list != nullptr && list->kind == Kind::array &&
        std::ranges::all_of(list->items, is_table)) {
      for (ConfigNode& item : list->items) merge(item, section);
    } else {
      ConfigNode one;
      one.items = {section};
      merge(root, one);
    }
  }
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
  if (only_radar.empty()) merge_into_lists(root, for_all);
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

constexpr double kReachMargin = 1.25;

/// Automatic cells leave room for the windows of a flight, two of which are in memory at times.
constexpr double kAutoShare = 4;

/// The finest posting of the national elevation models (3DEP): finer ground does not exist.
constexpr double kFinestFootprint_m = 1.0;

/// How densely a radar samples the ground along range: the finer of its range bins and its pixel rows, both
/// taken as evenly spread over the swath, as the oblique frustum does at the terrain's top. The sweep
/// has no rows; it sees whatever ground there is, and two cells a bin are as fine as rays are by default.
double sampling_footprint_m(const RadarSettings& s) {
  if (s.frustum == FrustumKind::sweep) return s.range_bin_m() / 2;
  return (s.r_max_m - s.r_min_m) / std::max(s.range_bins, s.pixel_rows);
}

}  // namespace

SceneConfig load_scene_file(const std::filesystem::path& path, const LoadOptions& options) {
  return load(parse_config_file(path), path, options);
}

SceneConfig load_scene_text(const std::string& text, const std::filesystem::path& path,
                            const LoadOptions& options) {
  return load(parse_config_text(text, path.string()), path, options);
}

SceneConfig load_serving(const std::filesystem::path& path, const LoadOptions& options) {
  const std::array<const Section*, 3> serving{&kServerSection, &kStreamSection, &kHttpSection};
  const auto serves = [&](std::string_view section) {
    return std::ranges::find(serving, section, &Section::name) != serving.end();
  };
  Complaints complaints;
  for (const std::string& flag : options.set) {
    const std::string key = flag.substr(0, flag.find('='));
    if (!serves(key.substr(0, key.find('.'))))
      complaints.add("--set", {key, "a key of another section", "keys of [server], [stream] and [http]"});
  }
  complaints.throw_if_any();
  ConfigNode off;
  off.kind = Kind::value;
  off.value = false;
  ConfigNode root = path.empty() ? nest("http.enabled", off) : parse_config_file(path);
  apply_overrides(root, options.set, complaints);
  std::erase_if(root.items, [&](const ConfigNode& node) { return !serves(node.key); });
  SceneConfig config;
  config.path = path;
  SectionReader top(root, "", complaints);
  const std::filesystem::path file = path.empty() ? "none" : path;
  SceneReading scene{config, top, complaints, std::filesystem::absolute(file).parent_path()};
  for (const Section* section : serving) read_section(scene, *section);
  top.finish();
  complaints.throw_if_any();
  return config;
}

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

std::string print_config(const SceneConfig& config) {
  return "# Scene " + toml_string(config.name) +
         ", complete. Live: changes with the next frame. Reload: read again at SIGHUP. Restart: read once, "
         "at "
         "start.\n" +
         printed_sections(config) + printed_list(kBuildings, config) + printed_corners(config) +
         printed_list(kPrisms, config) + printed_list(kSurfaces, config) + printed_radars(config) +
         printed_targets(config) + printed_materials(config);
}

double loaded_radius_m(double r_max_m) { return kReachMargin * r_max_m; }

void set_terrain_reach(SceneConfig& config) {
  WorldSpec& world = config.world;
  const auto place = [](const RadarConfig& radar) {
    return LonLat{radar.pose.longitude_deg, radar.pose.latitude_deg};
  };
  world.origin = place(config.radars.front());
  world.reaches.clear();
  double footprint_m = std::numeric_limits<double>::infinity();
  for (const RadarConfig& radar : config.radars) {
    world.reaches.push_back({place(radar), loaded_radius_m(radar.settings.r_max_m)});
    footprint_m = std::min(footprint_m, sampling_footprint_m(radar.settings));
  }
  world.terrain.most_auto_posts = config.flight.max_megaposts * 1e6 / kAutoShare;
  world.sampling_footprint_m = std::max(footprint_m, kFinestFootprint_m);
}

}  // namespace obliq
