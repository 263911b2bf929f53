// [terrain], [earth], [accuracy], [run], [server], [modbus], [materials.*], [[buildings]], [[prisms]],
// [[surfaces]].
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "server/control/land_cover.h"
#include "server/control/material_library.h"
#include "server/control/modbus_keys.h"
#include "server/control/scene_keys.h"
#include "server/control/scene_sections.h"
#include "terrain/cache/ground_cache.h"

namespace obliq {

namespace {

using Kind = ConfigNode::Kind;

/// Reads the entries directly below `prefix` (not those of its sub-tables).
void read_entries(SectionReader& reader, std::string_view prefix, SceneConfig& config) {
  for (const auto& [key, slot] : scene_entries()) {
    if (!key.name.starts_with(prefix)) continue;
    const std::string_view local = key.name.substr(prefix.size());
    if (local.find('.') == std::string_view::npos) reader.read(local, key, slot(config));
  }
}

template <class T>
void read_all(SectionReader& reader, std::span<const Row<T>> entries, T& object) {
  for (const auto& [key, slot] : entries) reader.read(key.name, key, slot(object));
}

/// A path as GDAL and the file system want it. Absolute ones, URLs, /vsi... and DRIVER:... stay as they are.
/// Those of a flag count from the working directory, those of the file from its folder.
std::string resolved_path(const ConfigNode& node, const std::filesystem::path& folder) {
  const std::string& text = std::get<std::string>(node.value);
  const std::size_t colon = text.find(':');
  const bool has_scheme = colon != std::string::npos && colon > 0 && text.find('/') > colon;
  if (text.front() == '/' || has_scheme) return text;
  const auto base = node.from_file ? folder : std::filesystem::current_path();
  return (base / text).lexically_normal().string();
}

std::string read_path(SceneReading& reading, SectionReader& reader, std::string_view name, bool required) {
  const ConfigNode* node = reader.take(name);
  if (node == nullptr) {
    if (required)
      reading.complaints.add(reader.table().where, {reader.full_name(name), "nothing", "a path in quotes"});
    return {};
  }
  const auto* text = node->kind == Kind::value ? std::get_if<std::string>(&node->value) : nullptr;
  if (text != nullptr && !text->empty()) return resolved_path(*node, reading.folder);
  reader.complain(*node, name, "a path in quotes");
  return {};
}

/// [[lon, lat], ...] of at least three corners that enclose something; empty when it is not that.
std::vector<LonLat> polygon_of(const ConfigNode& node) {
  std::vector<LonLat> corners;
  for (const ConfigNode& item : node.items) {
    Complaints unheard;
    ConfigNode holder;
    holder.items = {item};
    holder.items[0].key = "corner";
    // Beyond 180: outlines across the antimeridian run on.
    const auto pair = SectionReader(holder, "", unheard).numbers("corner", closed(-360, 360), 2, 2);
    if (pair.size() != 2 || std::abs(pair[1]) > 90) return {};
    corners.push_back({pair[0], pair[1]});
  }
  double doubled_area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const LonLat& a = corners[i];
    const LonLat& b = corners[(i + 1) % corners.size()];
    doubled_area += a.longitude_deg * b.latitude_deg - b.longitude_deg * a.latitude_deg;
  }
  return corners.size() >= 3 && doubled_area != 0 ? corners : std::vector<LonLat>{};
}

void read_area(SectionReader& reader, TerrainSpec& terrain) {
  constexpr auto kAllowed =
      "[west, south, east, north] in degrees with south < north, at most 180 degrees eastward from west to "
      "east, or a polygon [[longitude, latitude], ...]";
  const ConfigNode* node = reader.take("area");
  if (node == nullptr) return;
  const bool nested = node->kind == Kind::array && !node->items.empty() && node->items[0].kind == Kind::array;
  if (nested) {
    terrain.area = polygon_of(*node);
    if (terrain.area.empty()) reader.complain(*node, "area", kAllowed);
    return;
  }
  auto box = reader.numbers("area", closed(-180, 180), 4, 4);
  if (box.empty()) return;
  // A west beyond the east is a box across the antimeridian; half a turn tells it from two swapped numbers.
  if (box[0] > box[2] && box[0] - box[2] > 180) box[2] += 360;
  if (box[0] < box[2] && box[1] < box[3] && box[1] >= -90 && box[3] <= 90) {
    terrain.area = {{box[0], box[1]}, {box[2], box[1]}, {box[2], box[3]}, {box[0], box[3]}};
  } else {
    reader.complain(*node, "area", kAllowed);
  }
}

/// "auto", which leaves the value empty, or a number within the key's limits.
void read_auto(SectionReader& reader, std::string_view name, const Key& key, std::optional<double>& value) {
  const ConfigNode* node = reader.take(name);
  if (node == nullptr) return;
  const auto* text = node->kind == Kind::value ? std::get_if<std::string>(&node->value) : nullptr;
  if (text != nullptr && *text == "auto") return;
  double number = 0;
  const bool good = node->kind == Kind::value && !store(key, &number, node->value) && !check(key, &number);
  if (good) {
    value = number;
  } else {
    reader.complain(*node, name, "\"auto\" or a " + allowed_text(key, &number));
  }
}

void read_unit(SectionReader& reader, TerrainSpec& terrain) {
  int index = 0;
  const ConfigNode* node = reader.take("unit");
  if (node == nullptr) return;
  const auto* text = node->kind == Kind::value ? std::get_if<std::string>(&node->value) : nullptr;
  const auto unit =
      std::ranges::find(vertical_units(), text != nullptr ? std::string_view(*text) : "", &Choice::name);
  if (unit == vertical_units().end()) {
    reader.complain(*node, "unit", allowed_text(Key{"", "", {}, vertical_units()}, &index));
  } else {
    terrain.unit = static_cast<VerticalUnit>(unit - vertical_units().begin());
  }
}

void read_cache(SceneReading& reading, SectionReader& reader, TerrainSpec& terrain) {
  terrain.cache_folder = usual_cache_folder();
  const ConfigNode* node = reader.take("cache");
  if (node == nullptr) return;
  const auto* text = node->kind == Kind::value ? std::get_if<std::string>(&node->value) : nullptr;
  if (text == nullptr || text->empty()) {
    reader.complain(*node, "cache", "\"auto\", \"off\" or a folder");
  } else if (text->front() == '~') {
    reader.complain(*node, "cache", "\"auto\", \"off\" or a folder whose path is written out, without ~");
  } else if (*text == "off") {
    terrain.cache_folder.clear();
  } else if (*text != "auto") {
    terrain.cache_folder = resolved_path(*node, reading.folder);
  }
}

/// Water that the elevation models show is looked for unless the scene does not want it.
void read_sea(SectionReader& reader, TerrainSpec& terrain) {
  const ConfigNode* node = reader.take("sea");
  const auto* text =
      node != nullptr && node->kind == Kind::value ? std::get_if<std::string>(&node->value) : nullptr;
  if (node != nullptr && (text == nullptr || (*text != "auto" && *text != "off"))) {
    reader.complain(*node, "sea", "\"auto\" or \"off\"");
  } else if ((text == nullptr || *text == "auto") && terrain.synthetic == SyntheticKind::none) {
    // The materials that ship keep their numbers whatever the scene makes of them.
    if (const auto water = find_material(shipped_materials(), "water"))
      terrain.water_material = static_cast<std::uint8_t>(*water);
  }
}

void read_terrain(SceneReading& reading, const ConfigNode& table) {
  TerrainSpec& terrain = reading.config.world.terrain;
  SectionReader reader(table, "terrain", reading.complaints);
  read_entries(reader, "terrain.", reading.config);
  for (const ConfigNode* path : reader.texts("dem"))
    terrain.dem.push_back(resolved_path(*path, reading.folder));
  read_area(reader, terrain);
  // The least cell is the grid's quantum (terrain/height_grid.h).
  read_auto(reader, "cell_m", Key{"terrain.cell_m", "m", closed(1.0 / 32, 10000)}, terrain.cell_m);
  read_auto(reader, "fill_void_m", Key{"terrain.fill_void_m", "m", closed(0, 100e3)}, terrain.fill_void_m);
  read_unit(reader, terrain);
  read_cache(reading, reader, terrain);
  read_sea(reader, terrain);
  std::string crs;
  if (reader.read("crs", Key{"terrain.crs", ""}, &crs)) terrain.crs = crs;
  reader.one_table("shape", [&](const ConfigNode& shape) {
    SectionReader inner(shape, "terrain.shape", reading.complaints);
    read_entries(inner, "terrain.shape.", reading.config);
    inner.finish();
  });
  reader.finish();

  const bool has_dem = table.find("dem") != nullptr;
  const bool has_synthetic = terrain.synthetic != SyntheticKind::none;
  if (!has_dem && !has_synthetic)
    reading.complaints.add(table.where,
                           {"terrain", "neither dem nor synthetic",
                            "dem = \"FILE\" (any GDAL path, or a list), or synthetic = \"hills\""});
  if (has_dem && has_synthetic)
    reading.complaints.add(table.where, {"terrain", "both dem and synthetic", "one of them"});
}

void read_material_name(SceneReading& reading, SectionReader& reader, std::uint8_t& id, bool required) {
  const std::vector<Material>& materials = reading.config.materials;
  std::string name;
  const bool given = reader.table().find("material") != nullptr;
  if (!reader.read("material", Key{"material", ""}, &name)) {
    if (required && !given)
      reading.complaints.add(reader.table().where,
                             {reader.full_name("material"), "nothing", "a material's name in quotes"});
    return;
  }
  if (const auto found = find_material(materials, name)) {
    id = static_cast<std::uint8_t>(*found);
    return;
  }
  std::string names;
  for (const Material& material : materials)
    names += (names.empty() ? "" : " | ") + toml_string(material.name);
  reader.complain(*reader.table().find("material"), "material", names);
}

/// A class raster whose legend is known: its classes have their materials from that.
void read_scheme(SceneReading& reading, SectionReader& reader, SurfaceSpec& spec) {
  if (!reader.read("scheme", Key{"surfaces.scheme", ""}, &spec.scheme)) return;
  const ConfigNode& node = *reader.table().find("scheme");
  const auto classes = land_cover(spec.scheme);
  if (!classes) return reader.complain(node, "scheme", std::string(kLandCoverSchemes));
  for (const std::string_view other : {"classes", "material", "where", "layer"}) {
    if (const ConfigNode* both = reader.table().find(other))
      reader.complain(*both, other, "nothing beside scheme, which says what each class is made of");
  }
  for (const LandCoverClass& each : *classes) {
    if (each.material.empty()) continue;
    const auto material = find_material(reading.config.materials, each.material);
    spec.scheme_materials.emplace_back(each.value, static_cast<std::uint8_t>(material.value()));
  }
}

/// [least, most], or one number for both.
void read_span(SectionReader& reader, std::string_view name, std::array<double, 2>& span_m) {
  const auto values = reader.numbers(name, closed(0.5, 1000), 1, 2);
  if (values.empty()) return;
  if (values.front() > values.back())
    reader.complain(*reader.table().find(name), name, "[least, most] with least no more than most");
  span_m = {values.front(), values.back()};
}

void resolve_server_paths(const ConfigNode& table, const std::filesystem::path& folder,
                          ServerConfig& server) {
  const std::pair<const char*, std::string*> paths[] = {
      {"tokens", &server.tokens}, {"tls_certificate", &server.tls_certificate}, {"tls_key", &server.tls_key}};
  for (const auto& [name, path] : paths) {
    const ConfigNode* node = table.find(name);
    if (node != nullptr && !path->empty()) *path = resolved_path(*node, folder);
  }
}

}  // namespace

void read_scene_entries(SceneReading& reading) {
  ConfigNode no_terrain;
  no_terrain.where = reading.config.path.string();
  // radius_factor stays NaN when nobody sets it; its default depends on the terrain.
  reading.config.world.radius_factor = std::numeric_limits<double>::quiet_NaN();
  // So does the gaps' limit, which depends on the error's.
  reading.config.accuracy.max_gap_fraction = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> sections = {"earth", "accuracy", "run"};
  sections.insert(sections.end(), daemon_sections().begin(), daemon_sections().end());
  for (const std::string& section : sections) {
    reading.top.one_table(section, [&](const ConfigNode& table) {
      SectionReader reader(table, section, reading.complaints);
      read_entries(reader, section + ".", reading.config);
      if (section == "server") resolve_server_paths(table, reading.folder, reading.config.server);
      if (section == "modbus") read_modbus_access(reader, reading.config.modbus);
      reader.finish();
    });
  }
  AccuracyWish& wish = reading.config.accuracy;
  if (std::isnan(wish.max_gap_fraction))
    wish.max_gap_fraction = std::isfinite(wish.max_power_error_db) ? AccuracyWish::kUsualGapFraction : 1;
  const ConfigNode* terrain = reading.top.take("terrain");
  if (terrain != nullptr && terrain->kind != Kind::table) {
    reading.top.complain(*terrain, "terrain", "a table");
  } else {
    read_terrain(reading, terrain != nullptr ? *terrain : no_terrain);
  }
  double& factor = reading.config.world.radius_factor;
  if (std::isnan(factor) && reading.complaints.empty())
    factor = reading.config.world.terrain.synthetic == SyntheticKind::none
                 ? WorldSpec{}.radius_factor
                 : std::numeric_limits<double>::infinity();
}

void read_materials(SceneReading& reading) {
  constexpr std::size_t kMost = 256;  // ids are bytes
  std::vector<Material>& materials = reading.config.materials;
  materials = shipped_materials();
  reading.top.one_table("materials", [&](const ConfigNode& all) {
    // By name, so that ids do not depend on whether a file or a flag named a material first.
    std::vector<ConfigNode> tables = all.items;
    std::ranges::sort(tables, {}, &ConfigNode::key);
    for (const ConfigNode& table : tables) {
      const std::string full_name = "materials." + toml_key(table.key);
      if (table.kind != Kind::table || table.key.empty() || table.key.size() > 64 ||
          materials.size() >= kMost) {
        reading.complaints.add(table.where,
                               {full_name, table.found_text(), "a table [materials.NAME], 256 at most"});
        continue;
      }
      auto id = find_material(materials, table.key);
      if (!id) {
        id = materials.size();
        materials.push_back({});
        materials.back().name = table.key;
      }
      MaterialKeys keys{materials[*id], to_db(materials[*id].gamma)};
      SectionReader reader(table, full_name, reading.complaints);
      read_all(reader, material_entries(), keys);
      reader.finish();
      if (table.find("gamma_db") != nullptr) keys.material.gamma = from_db(keys.gamma_db);
      materials[*id] = keys.material;
    }
  });
}

void read_buildings(SceneReading& reading) {
  reading.top.each_table("buildings", [&](const ConfigNode& table) {
    BuildingSourceSpec spec;
    SectionReader reader(table, "buildings", reading.complaints);
    spec.source = read_path(reading, reader, "source", true);
    read_all(reader, building_entries(), spec);
    if (reader.read("unit", Key{"buildings.unit", ""}, &spec.unit) && spec.unit != "m" && spec.unit != "ft" &&
        !spec.unit.empty())
      reader.complain(*table.find("unit"), "unit", "\"m\" | \"ft\"");
    read_material_name(reading, reader, spec.material, false);
    reader.finish();
    reading.config.world.buildings.push_back(spec);
  });
}

void read_prisms(SceneReading& reading) {
  reading.top.each_table("prisms", [&](const ConfigNode& table) {
    PrismSpec spec;
    SectionReader reader(table, "prisms", reading.complaints);
    const ConfigNode* within = table.find("within");
    if (within != nullptr && within->kind == Kind::array) {
      reader.take("within");
      spec.within_polygon = polygon_of(*within);
      if (spec.within_polygon.empty())
        reader.complain(*within, "within",
                        "a path in quotes, or a polygon [[longitude, latitude], ...], degrees");
    } else {
      spec.within = read_path(reading, reader, "within", false);
    }
    read_all(reader, prism_entries(), spec);
    read_span(reader, "width_m", spec.width_m);
    read_span(reader, "length_m", spec.length_m);
    read_span(reader, "height_m", spec.height_m);
    read_material_name(reading, reader, spec.material, false);
    reader.finish();
    reading.config.world.prisms.push_back(spec);
  });
}

void read_surfaces(SceneReading& reading) {
  reading.top.each_table("surfaces", [&](const ConfigNode& table) {
    SurfaceSpec spec;
    SectionReader reader(table, "surfaces", reading.complaints);
    spec.source = read_path(reading, reader, "source", true);
    read_all(reader, surface_entries(), spec);
    read_scheme(reading, reader, spec);
    for (const double value : reader.numbers("classes", closed(-1e9, 1e9), 1, 4096)) {
      if (value != std::floor(value)) reader.complain(*table.find("classes"), "classes", "whole numbers");
      spec.classes.push_back(static_cast<int>(value));
    }
    read_material_name(reading, reader, spec.material, spec.scheme.empty());
    reader.finish();
    reading.config.world.surfaces.push_back(spec);
  });
}

}  // namespace obliq
