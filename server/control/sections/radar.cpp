#include "server/control/sections/radar.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "server/control/parameters.h"
#include "server/control/planes_per_bin.h"
#include "server/control/quality_presets.h"
#include "server/control/radar_presets.h"
#include "server/control/sections/parameter_row.h"
#include "server/control/sections/platform.h"
#include "server/control/sections/radar_aliases.h"
#include "server/control/sections/section.h"
#include "server/control/sections/special_values.h"
#include "server/radar/beam/pattern_cuts.h"

namespace obliq {

namespace {

using Kind = ConfigNode::Kind;

const std::array kShortForms{
    special<RadarConfig>(
        "radar.preset", "", radar_preset_choices(), "",
        "A whole radar: what the scene's own keys do not name. `obliq parameters --preset NAME` prints it.",
        nullptr, nullptr, "\"\"", Change::reload),
    special<RadarConfig>("radar.platform", "", kAny, "the name of a [[platform]]",
                         "What the radar rides on, by [mount]: its place and motion are the platform's.",
                         nullptr, nullptr, "\"\"", Change::restart),
    special<RadarConfig>("radar.polarisation", "", kPolarisations, "",
                         "Another name of atmosphere.polarisation.", nullptr, nullptr, "\"horizontal\"",
                         Change::live),
    special<RadarConfig>("frustum.quality", "", quality_choices(), "",
                         "Sets kind, plates, planes_per_bin or pixel_columns, and pixel_rows; the default "
                         "where [frustum] is empty.",
                         nullptr, nullptr, "\"standard\"", Change::live),
    special<RadarConfig>("frustum.pixels", "", closed(1, 16384),
                         "[columns, rows], or one integer; not beside pixel_columns and pixel_rows;",
                         "Sets pixel_columns and pixel_rows.", nullptr, nullptr, "2048", Change::live),
    special<RadarConfig>("beam.file", "", kAny, "the path of a table cut,angle_deg,gain_db",
                         "What the patterns \"file\" are, by the cuts azimuth and elevation.", nullptr,
                         nullptr, "\"\"", Change::reload),
};

using OfMount = RowsOf<Change::restart, &RadarConfig::mount>;
constexpr Limits kArm = closed(-1000, 1000);

const std::array kMountRows{
    OfMount::row<&Mount::forward_m>("mount.forward_m", "m", kArm,
                                    "How far before its platform's reference point the antenna is."),
    OfMount::row<&Mount::right_m>("mount.right_m", "m", kArm, "How far to the right of it."),
    OfMount::row<&Mount::up_m>("mount.up_m", "m", kArm, "How far above it, in the platform's own axes."),
    OfMount::row<&Mount::look_deg>("mount.look_deg", "deg", closed(-360, 360),
                                   "Centre of the sector at the start, clockwise from the nose."),
    OfMount::row<&Mount::gimbal, &GimbalLimits::azimuth_min_deg>(
        "mount.azimuth_min_deg", "deg", closed(-180, 180),
        "How far the gimbal turns to the left of where the mount looks."),
    OfMount::row<&Mount::gimbal, &GimbalLimits::azimuth_max_deg>("mount.azimuth_max_deg", "deg",
                                                                 closed(-180, 180), "And to the right."),
    OfMount::row<&Mount::gimbal, &GimbalLimits::elevation_min_deg>(
        "mount.elevation_min_deg", "deg", closed(-90, 90),
        "How far it tilts down, against the platform's own level."),
    OfMount::row<&Mount::gimbal, &GimbalLimits::elevation_max_deg>("mount.elevation_max_deg", "deg",
                                                                   closed(-90, 90), "And up."),
};

/// What the scene says about a radar's frustum.
enum class FrustumChoice { named, no_kind, nothing };
constexpr std::string_view kFrustum = "frustum";

/// One radar while it is read: its values, and where each was set.
struct RadarReading {
  RadarConfig config;
  std::map<std::string, std::string> set_at;
  FrustumChoice choice = FrustumChoice::named;
};

/// Keys that may say "auto", and the switch that it is.
struct AutoKey {
  std::string_view key;
  std::string_view flag;
  bool& (*slot)(RadarConfig&);
};
constexpr AutoKey kAutoKeys[] = {
    {"antenna.tilt_deg", "antenna.tilt_auto", [](RadarConfig& c) -> bool& { return c.pose.tilt_auto; }},
    {"video.floor_db", "video.floor_auto",
     [](RadarConfig& c) -> bool& { return c.settings.video.floor_auto; }},
    {"sea.state", "sea.state_auto", [](RadarConfig& c) -> bool& { return c.settings.sea.state_auto; }},
};

/// Whether a key is there and says "auto"; then it has been read.
bool reads_auto(SectionReader& reader, const std::string& name) {
  const ConfigNode* node = reader.table().find(name);
  const auto* text = node == nullptr ? nullptr : std::get_if<std::string>(&node->value);
  return text != nullptr && *text == "auto" && reader.take(name) != nullptr;
}

/// Reads the parameters of one section from a table that holds them.
void read_parameters(SectionReader& reader, const std::string& section, RadarReading& radar) {
  for (const Parameter& parameter : parameters()) {
    const std::string name(parameter.key.name);
    if (!name.starts_with(section + ".")) continue;
    const std::string local = name.substr(section.size() + 1);
    const auto* const automatic = std::ranges::find(kAutoKeys, name, &AutoKey::key);
    if (automatic != std::end(kAutoKeys) && reads_auto(reader, local)) {
      automatic->slot(radar.config) = true;
      radar.set_at[std::string(automatic->flag)] = reader.table().find(local)->where;
      continue;
    }
    if (reader.read_unchecked(local, parameter.key, parameter.slot(radar.config)))
      radar.set_at[name] = reader.table().find(local)->where;
  }
}

/// beam.file, which no message carries.
void read_special(SceneReading& scene, SectionReader& reader, RadarReading& radar) {
  RadarSettings& settings = radar.config.settings;
  if (reader.full_name("file") != "beam.file") return;
  const ConfigNode* file = reader.take("file");
  if (file == nullptr) return;
  const auto* path = std::get_if<std::string>(&file->value);
  if (path == nullptr) return reader.complain(*file, "file", "the path of a table cut,angle_deg,gain_db");
  if (!path->empty())
    settings.beam.file =
        std::make_shared<const PatternCuts>(read_pattern_cuts(resolved_path(*file, scene.folder)));
}

/// The table of that name; null if there is none.
const ConfigNode* table_in(SectionReader& holder, std::string_view name) {
  const ConfigNode* table = holder.take(name);
  if (table == nullptr || table->kind == Kind::table) return table;
  holder.complain(*table, name, "a table");
  return nullptr;
}

void read_frustum(const ConfigNode& table, RadarReading& radar, Complaints& complaints) {
  const RadarSettings& settings = radar.config.settings;
  const Frustum frustum = resolved_frustum(table, settings.azimuth_bins, settings.range_bins);
  if (frustum.finds_pixels) radar.config.finds_pixels = *frustum.finds_pixels;
  SectionReader reader(frustum.table, std::string(kFrustum), complaints);
  read_parameters(reader, std::string(kFrustum), radar);
  for (const auto& [key, form, read, print, default_text, change] : kShortForms)
    if (const ConfigNode* node = reader.take(name_in(kFrustum, key.name)))
      reader.complain(*node, name_in(kFrustum, key.name), allowed_text(key, form));
  reader.finish();
}

/// The platform that a radar names; null if it names none.
std::shared_ptr<const PlatformConfig> read_ride(SceneReading& scene, SectionReader& own) {
  const ConfigNode* node = own.take("platform");
  if (node == nullptr) return nullptr;
  const auto* name = std::get_if<std::string>(&node->value);
  if (name != nullptr && name->empty()) return nullptr;
  std::string names;
  for (const auto& platform : scene.config.platforms) {
    if (name != nullptr && platform->name == *name) return platform;
    names += (names.empty() ? "" : ", ") + toml_string(platform->name);
  }
  own.complain(*node, "platform", names.empty() ? "the name of a [[platform]]; there is none" : names);
  return nullptr;
}

/// A radar that rides has no place of its own.
void refuse_place(const ConfigNode& antenna, const PlatformConfig& platform, Complaints& complaints) {
  for (const ConfigNode& node : antenna.items)
    if (!node.key.starts_with("tilt"))
      complaints.add(node.where, {"antenna." + node.key, "a place of its own",
                                  "tilt_deg and tilt_auto alone: the radar rides on platform " +
                                      toml_string(platform.name) + "; [mount] says where"});
}

/// Limits that leave the gimbal nothing.
void check_gimbal(const ConfigNode& table, const GimbalLimits& gimbal, Complaints& complaints) {
  const auto check = [&](std::string_view angle, double least, double most) {
    if (least >= most)
      complaints.add(table.where, {fmt::format("mount.{}_min_deg", angle), toml_number(least),
                                   fmt::format("below mount.{}_max_deg, {}", angle, toml_number(most))});
  };
  check("azimuth", gimbal.azimuth_min_deg, gimbal.azimuth_max_deg);
  check("elevation", gimbal.elevation_min_deg, gimbal.elevation_max_deg);
}

/// Gives a radar without a named frustum that of kDefaultQuality.
FrustumChoice choose_frustum(std::vector<ConfigNode>& frusta) {
  // Planes in each bin are the sweep's.
  const auto empty = [](const ConfigNode& frustum) {
    return std::ranges::all_of(frustum.items, [](const ConfigNode& n) { return n.key == "planes_per_bin"; });
  };
  const auto names_kind = [](const ConfigNode& f) {
    return f.find("kind") != nullptr || f.find("quality") != nullptr;
  };
  if (std::ranges::any_of(frusta, names_kind)) return FrustumChoice::named;
  if (!std::ranges::all_of(frusta, empty)) return FrustumChoice::no_kind;
  ConfigNode quality;
  quality.kind = Kind::value;
  quality.where = "default";
  quality.value = std::string(kDefaultQuality);
  frusta.insert(frusta.begin(), nest("quality", quality));
  return FrustumChoice::nothing;
}

/// Says which radars have a frustum that no source names.
void note_choice(SceneConfig& config, const std::vector<std::string>& radars, const std::string& text) {
  if (radars.empty()) return;
  std::string of_radars;
  if (radars.size() < config.radars.size())
    for (const std::string& name : radars) of_radars += (of_radars.empty() ? "radar " : ", ") + name;
  config.notes.push_back(of_radars + (of_radars.empty() ? "" : ": ") + text);
}

/// The tree of the preset that a radar names; without keys if it names none.
ConfigNode read_preset(SectionReader& own) {
  const ConfigNode* node = own.take("preset");
  if (node == nullptr) return {};
  const auto* name = std::get_if<std::string>(&node->value);
  const RadarPreset* preset = name != nullptr ? find_radar_preset(*name) : nullptr;
  if (preset != nullptr) return preset_tree(*preset);
  own.complain(*node, "preset", choices_text(radar_preset_choices()));
  return {};
}

RadarReading read_radar(SceneReading& scene, const ConfigNode& table) {
  RadarReading radar;
  SectionReader own(table, "radar", scene.complaints);
  read_name(own, "radar.name", radar.config.name);
  radar.config.platform = read_ride(scene, own);
  const ConfigNode preset = read_preset(own);
  SectionReader given(preset, "", scene.complaints);
  if (const ConfigNode* of_radar = given.take("radar")) {
    SectionReader reader(*of_radar, "radar", scene.complaints);
    read_parameters(reader, "radar", radar);
    reader.finish();
  }
  read_parameters(own, "radar", radar);
  std::vector<ConfigNode> frusta;
  // What a radar names itself beats what all share, and that beats its preset.
  for (SectionReader* holder : {&given, &scene.top, &own}) {
    for (const std::string_view name : kRadarTables) {
      const ConfigNode* found = table_in(*holder, name);
      if (found == nullptr) continue;
      if (name == kFrustum) {
        frusta.push_back(*found);
        continue;
      }
      if (name == "antenna" && radar.config.platform && holder != &given)
        refuse_place(*found, *radar.config.platform, scene.complaints);
      if (name == "mount" && !radar.config.platform)
        scene.complaints.add(found->where,
                             {"mount", "a radar that rides on nothing", "radar.platform beside it"});
      SectionReader reader(*found, std::string(name), scene.complaints);
      if (name == "mount") {
        read_keys(scene, reader, Keys<RadarConfig>{kMountRows}, name, radar.config);
        check_gimbal(*found, radar.config.mount.gimbal, scene.complaints);
      }
      read_parameters(reader, std::string(name), radar);
      read_special(scene, reader, radar);
      reader.finish();
    }
  }
  read_aliases(scene, own, radar.config, radar.set_at);
  // A number without a word on the switch is meant.
  for (const AutoKey& automatic : kAutoKeys)
    if (radar.set_at.contains(std::string(automatic.key)) &&
        !radar.set_at.contains(std::string(automatic.flag)))
      automatic.slot(radar.config) = false;
  if (!radar.set_at.contains("antenna.heading_deg"))
    radar.config.pose.heading_deg = radar.config.pose.bearing_deg;
  if (radar.config.platform)
    radar.config.pose = riding_at_start(*radar.config.platform, radar.config.mount, radar.config.pose);
  given.finish();
  own.finish();
  radar.choice = choose_frustum(frusta);
  for (const ConfigNode& frustum : frusta) read_frustum(frustum, radar, scene.complaints);

  // A sweep that names no quality has the columns that it always had; they follow the bins from here on.
  RadarSettings& settings = radar.config.settings;
  if (settings.frustum == FrustumKind::sweep && settings.planes_per_bin == 0 && settings.azimuth_bins >= 1 &&
      !radar.set_at.contains("frustum.pixel_columns"))
    settings.planes_per_bin = sweep_columns_per_bin(settings);
  settle_planes(settings, false);
  radar.config.finds_pixels &= radar.config.settings.frustum == FrustumKind::oblique;
  std::vector<FieldError> errors = validate(radar.config);
  for (FieldError& error : flat_plate_faults(radar.config.settings, scene.config.materials))
    errors.push_back(std::move(error));
  for (const FieldError& error : errors) {
    const auto at = radar.set_at.find(error.field);
    scene.complaints.add(at != radar.set_at.end() ? at->second : table.where, error);
  }
  if (radar.config.pose.height_reference == HeightReference::ellipsoid && !radar.config.platform &&
      !radar.set_at.contains("antenna.geoid_undulation_m"))
    scene.complaints.add(radar.set_at.at("antenna.height_reference"),
                         {"antenna.geoid_undulation_m", "nothing with height_reference = \"ellipsoid\"",
                          "the geoid's height above the ellipsoid there, m"});
  return radar;
}

/// As TOML; empty where there is nothing to print.
std::string special_value(std::string_view name, const RadarConfig& radar) {
  const RadarSettings& settings = radar.settings;
  if (name == "radar.platform" && radar.platform) return toml_string(radar.platform->name);
  if (name == "beam.file" && settings.beam.file) return toml_string(settings.beam.file->path.string());
  return {};
}

std::string printed_parameters(std::string_view table, RadarConfig radar) {
  std::string text;
  if (radar.finds_pixels && table == kFrustum)
    text +=
        printed_line("quality", "\"oblique\"", "Finds pixel_columns and pixel_rows when the scene is loaded.",
                     choices_text(quality_choices()), Change::reload);
  const bool by_planes = radar.settings.frustum == FrustumKind::sweep && radar.settings.planes_per_bin > 0;
  for (const Parameter& p : parameters()) {
    const auto name = name_in(table, p.key.name);
    const bool follows = by_planes && name == "pixel_columns";  // beside planes_per_bin it would decide
    if (!name.empty() && !follows && !is_of_platform(radar, p) &&
        !(radar.finds_pixels && name.starts_with("pixel_")))
      text += printed_line(name, toml_text(load(p.key, p.slot(radar))), p.key.summary,
                           allowed_text(p.key, p.slot(radar)), p.change);
  }
  for (const auto& [key, form, read, print, default_text, change] : kShortForms) {
    const std::string value = special_value(key.name, radar);
    if (!value.empty() && !name_in(table, key.name).empty())
      text += printed_line(name_in(table, key.name), value, key.summary, allowed_text(key, form), change);
  }
  return text;
}

}  // namespace

std::span<const SpecialKey<RadarConfig>> radar_special_keys() { return kShortForms; }
std::span<const Row<RadarConfig>> mount_rows() { return kMountRows; }

std::vector<MissingPosition> read_radars(SceneReading& scene) {
  std::vector<MissingPosition> missing;
  const int most = scene.config.server.max_radars;
  const ConfigNode* list = scene.top.take("radar");
  if (list != nullptr && list->kind == Kind::array && list->items.size() > static_cast<std::size_t>(most)) {
    scene.complaints.add(scene.config.path.string(),
                         {"radar", std::to_string(list->items.size()) + " radars",
                          "at most " + std::to_string(most) + " (server.max_radars)"});
    return missing;
  }
  std::vector<std::string> nothing, no_kind;
  const auto read_one = [&](const ConfigNode& table) {
    const RadarReading radar = read_radar(scene, table);
    std::vector<RadarConfig>& radars = scene.config.radars;
    if (std::ranges::find(radars, radar.config.name, &RadarConfig::name) != radars.end())
      scene.complaints.add(table.where, {"radar.name", "a second " + toml_string(radar.config.name),
                                         "a name of its own for each [[radar]]"});
    for (const auto& platform : scene.config.platforms)
      if (platform->name == radar.config.name)
        scene.complaints.add(table.where, {"radar.name", toml_string(radar.config.name) + ", a platform's",
                                           "a name that no [[platform]] has"});
    const bool rides = radar.config.platform != nullptr;
    const bool no_latitude = !rides && !radar.set_at.contains("antenna.latitude_deg");
    const bool no_longitude = !rides && !radar.set_at.contains("antenna.longitude_deg");
    if (no_latitude || no_longitude) missing.push_back({radars.size(), no_latitude, no_longitude});
    if (radar.choice == FrustumChoice::nothing) nothing.push_back(radar.config.name);
    if (radar.choice == FrustumChoice::no_kind) no_kind.push_back(radar.config.name);
    radars.push_back(radar.config);
  };
  // apply_overrides has made a [radar] where there was none, but `radar = []` remains possible.
  scene.top.each_table("radar", read_one);
  note_empty_platforms(scene.config);
  note_choice(scene.config, nothing,
              "no frustum named: sweep \"" + std::string(kDefaultQuality) +
                  "\"; frustum.kind = \"oblique\" casts rays with Embree");
  note_choice(
      scene.config, no_kind,
      "frustum.kind is not named: \"oblique\", rays cast with Embree; frustum.quality = \"standard\" takes "
      "the sweep");
  if (scene.config.radars.empty() && scene.complaints.empty())
    scene.complaints.add(scene.config.path.string(), {"radar", "an empty list", "at least one [[radar]]"});
  return missing;
}

std::string printed_radars(const SceneConfig& config) {
  std::string text = printed_platforms(config);
  for (const RadarConfig& radar : config.radars) {
    text += "\n[[radar]]\nname = " + toml_string(radar.name) + "\n" + printed_parameters("radar", radar);
    for (const std::string_view table : kRadarTables) {
      if (table == "mount" && !radar.platform) continue;
      text += "\n[radar." + std::string(table) + "]\n" +
              (table == "mount" ? printed_keys(Keys<RadarConfig>{kMountRows}, table, radar, config)
                                : printed_parameters(table, radar));
    }
  }
  return text;
}

}  // namespace obliq
