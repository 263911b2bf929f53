#include "server/control/print_config.h"

#include "server/control/material_library.h"
#include "server/control/parameters.h"
#include "server/control/scene_keys.h"
#include "terrain/cache/ground_cache.h"

namespace obliq {

namespace {

std::string line(std::string_view name, const std::string& value, const std::string& comment = {}) {
  std::string text = toml_key(name) + " = " + value;
  if (!comment.empty()) {
    if (text.size() < 32) text.append(32 - text.size(), ' ');
    text += "  # " + comment;
  }
  return text + '\n';
}

std::string entry_line(std::string_view name, const Key& key, const Slot& slot, const char* change) {
  return line(name, toml_text(load(key, slot)),
              std::string(key.summary) + " [" + allowed_text(key, slot) + "; " + change + "]");
}

std::string header(const std::string& name) { return "\n[" + name + "]\n"; }
std::string list_header(const std::string& name) { return "\n[[" + name + "]]\n"; }

/// "[a, b]" of whatever `each` makes of the items.
template <class Items, class Each>
std::string list(const Items& items, Each each) {
  std::string text = "[";
  for (const auto& item : items) text += (text.size() > 1 ? ", " : "") + each(item);
  return text + "]";
}

std::string polygon(const std::vector<LonLat>& corners) {
  return list(corners, [](const LonLat& corner) {
    return "[" + toml_number(corner.longitude_deg) + ", " + toml_number(corner.latitude_deg) + "]";
  });
}

std::string numbers(const std::array<double, 2>& pair) { return list(pair, toml_number); }

/// The entries directly below a prefix.
std::string section(const std::string& prefix, SceneConfig config) {
  std::string text;
  for (const auto& [key, slot] : scene_entries()) {
    if (!key.name.starts_with(prefix)) continue;
    const std::string_view local = key.name.substr(prefix.size());
    if (local.find('.') == std::string_view::npos) text += entry_line(local, key, slot(config), "restart");
  }
  return text;
}

template <class T>
std::string all_entries(std::span<const Row<T>> entries, T object) {
  std::string text;
  for (const auto& [key, slot] : entries) text += entry_line(key.name, key, slot(object), "restart");
  return text;
}

std::string terrain(const SceneConfig& config) {
  const TerrainSpec& spec = config.world.terrain;
  std::string text = header("terrain");
  if (!spec.dem.empty())
    text += line("dem", list(spec.dem, [](const std::string& path) { return toml_string(path); }),
                 "Elevation models: any GDAL paths. [restart]");
  if (spec.unit)
    text += line("unit", toml_string(vertical_units()[static_cast<std::size_t>(*spec.unit)].name),
                 "Unit of the dem's heights. [restart]");
  if (spec.crs) text += line("crs", toml_string(*spec.crs), "For a dem that carries none. [restart]");
  if (!spec.area.empty())
    text += line("area", polygon(spec.area), "What is loaded: longitude, latitude. [restart]");
  text += line("cell_m", spec.cell_m ? toml_number(*spec.cell_m) : "\"auto\"",
               "Spacing of the ground grid, m, or \"auto\". [restart]");
  text += line("fill_void_m", spec.fill_void_m ? toml_number(*spec.fill_void_m) : "\"auto\"",
               "Voids no wider than this are filled, m, or \"auto\". [restart]");
  const std::string& cache = spec.cache_folder;
  text += line("cache",
               cache.empty()                   ? "\"off\""
               : cache == usual_cache_folder() ? "\"auto\""
                                               : toml_string(cache),
               "Folder where grids are kept for the next start, \"auto\" or \"off\". [restart]");
  if (spec.synthetic == SyntheticKind::none)
    text += line("sea", spec.water_material ? "\"auto\"" : "\"off\"",
                 "Water that the dem itself shows, \"auto\" or \"off\". [restart]");
  text += section("terrain.", config);
  if (spec.synthetic != SyntheticKind::none)
    text += header("terrain.shape") + section("terrain.shape.", config);
  return text;
}

std::string sources(const SceneConfig& config) {
  const auto material = [&](std::uint8_t id) {
    return line("material", toml_string(config.materials.at(id).name));
  };
  std::string text;
  for (const BuildingSourceSpec& spec : config.world.buildings) {
    text += list_header("buildings") + line("source", toml_string(spec.source)) +
            all_entries(building_entries(), spec) + material(spec.material);
    if (!spec.unit.empty()) text += line("unit", toml_string(spec.unit));
  }
  for (const PrismSpec& spec : config.world.prisms) {
    text += list_header("prisms");
    if (!spec.within.empty()) text += line("within", toml_string(spec.within));
    if (!spec.within_polygon.empty()) text += line("within", polygon(spec.within_polygon));
    text += all_entries(prism_entries(), spec) + line("width_m", numbers(spec.width_m)) +
            line("length_m", numbers(spec.length_m)) + line("height_m", numbers(spec.height_m)) +
            material(spec.material);
  }
  for (const SurfaceSpec& spec : config.world.surfaces) {
    text += list_header("surfaces") + line("source", toml_string(spec.source)) +
            (spec.scheme.empty() ? all_entries(surface_entries(), spec) + material(spec.material)
                                 : line("scheme", toml_string(spec.scheme)));
    if (!spec.classes.empty())
      text += line("classes", list(spec.classes, [](int value) { return std::to_string(value); }));
  }
  return text;
}

std::string materials(const SceneConfig& config) {
  std::string text;
  for (const Material& m : config.materials)
    text += header("materials." + toml_key(m.name)) + all_entries(material_entries(), {m, to_db(m.gamma)});
  return text;
}

std::string parameter_lines(const std::string& prefix, RadarConfig radar) {
  std::string text;
  if (radar.finds_pixels && prefix == "frustum.")
    text += line("quality", "\"oblique\"",
                 "Finds pixel_columns and pixel_rows when the scene is loaded. [restart]");
  for (const Parameter& p : parameters())
    if (p.key.name.starts_with(prefix) && !(radar.finds_pixels && p.key.name.starts_with("frustum.pixel_")))
      text += entry_line(p.key.name.substr(prefix.size()), p.key, p.slot(radar),
                         p.change == Change::live ? "live" : "restart");
  return text;
}

std::string radars(const SceneConfig& config) {
  std::string text;
  for (const RadarConfig& radar : config.radars) {
    text += list_header("radar") + line("name", toml_string(radar.name)) + parameter_lines("radar.", radar);
    for (const std::string part : {"antenna", "frustum", "bins", "scan"})
      text += header("radar." + part) + parameter_lines(part + ".", radar);
  }
  return text;
}

}  // namespace

std::string print_config(const SceneConfig& config) {
  std::string daemon;
  for (const std::string_view name : daemon_sections()) {
    daemon += header(std::string(name)) + section(std::string(name) + ".", config);
    if (name == "modbus" && !config.modbus.allow.empty())
      daemon += line("allow", list(config.modbus.allow, toml_string), "Who may connect. [restart]");
  }
  return "# Scene " + toml_string(config.name) +
         ", complete. Live: changes with the next frame. Restart: read once, at start.\n" + terrain(config) +
         header("earth") + section("earth.", config) + sources(config) + radars(config) + materials(config) +
         header("accuracy") + section("accuracy.", config) + header("run") + section("run.", config) + daemon;
}

}  // namespace obliq
