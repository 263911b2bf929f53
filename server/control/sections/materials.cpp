#include "server/control/sections/materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "server/control/sections/section.h"
#include "server/control/sections/special_values.h"

namespace obliq {

namespace {

// Constant gamma, sigma0 = gamma cos(theta), at 10 GHz. It describes the plateau of land clutter, grazing
// angles from a few degrees to about 60; elsewhere it is a stand-in. Gamma grows with frequency by about
// 5 log10(f / 10 GHz) dB, which is not applied: at another band, set gamma_db.
//   [L] M. W. Long, Radar Reflectivity of Land and Sea, 3rd ed., Artech House 2001
//   [N] F. E. Nathanson, Radar Design Principles, 2nd ed., SciTech 1999
//   [B] D. K. Barton, "Land Clutter Models for Radar Design and Analysis", Proc. IEEE 73(2), 1985: crops,
//       bushes and trees -10 to -15; desert, grassland and marshes near -20; towns and mountains near -5
constexpr double kFarmland_db = -15;    // [N] farmland; ground that nothing else claims, so that houses show
constexpr double kSeaState3_db = -40;   // [L] sea state 3; still water returns less
constexpr double kMetropolitan_db = 0;  // [L] metropolitan
constexpr double kWoods_db = -15;       // [L] woods; wooded hills are -10 in [N]
constexpr double kBushes_db = -15;      // [B] the lower end, as [L] has woods
constexpr double kGrass_db = -20;       // [B]; [N] has -20 for flatland
constexpr double kMarsh_db = -20;       // [B]
constexpr double kDesert_db = -20;      // [B]
constexpr double kSuburb_db = -5;       // [B] towns

// A town's clutter has its corners in it: with these reckoned for themselves the rest of a house of 20 x 20 x
// 8 m on ground of rms slope 0.1 is so far below that a town's mean stays within 2.1 dB at grazing angles of
// 5 to 30 deg (tests/accuracy/radar/echo/corners_test.cpp).
constexpr double kFloorBesideCorners_db = -10;

// Relative permittivity at 10 GHz, e' and e''. Of concrete ITU-R P.2040-3, table 3 (e' = 5.24, conductivity
// 0.0462 f^0.7822 S/m: e'' = 0.50 at 10 GHz), brick 3.91 and 0.06. Other materials: ground, moist by a tenth.
constexpr double kMasonry[] = {5.3, 0.3};

Material diffuse(const char* name, double gamma_db) {
  Material material;
  material.name = name;
  material.gamma = from_db(gamma_db);
  return material;
}

/// What grows and moves in the wind.
Material growing(const char* name, double gamma_db) {
  Material material = diffuse(name, gamma_db);
  material.wind = true;
  return material;
}

/// Returns as the sea does where there is a sea state.
Material water() {
  Material material = diffuse("water", kSeaState3_db);
  material.model = ScatteringModel::sea;
  return material;
}

/// Highly specular, as the paper has its buildings, over a floor of what towns return on average.
Material building() {
  Material material;
  material.name = "building";
  material.model = ScatteringModel::geometric_optics;
  material.gamma = from_db(kMetropolitan_db);
  material.permittivity_re = kMasonry[0];
  material.permittivity_im = kMasonry[1];
  return material;
}

constexpr Limits kReal = closed(1, 1e6);
constexpr Limits kLoss = closed(0, 1e9);

void read_permittivity(const FoundKey& found, MaterialKeys& keys) {
  const std::vector<ConfigNode>& items = found.node.items;
  double parts[2]{};
  bool good = found.node.kind == ConfigNode::Kind::array && items.size() == 2;
  for (std::size_t k = 0; good && k < 2; ++k)
    good = !store_node(found.key, &parts[k], items[k]) && (k == 0 ? kReal : kLoss).contains(parts[k]);
  if (!good) {
    const std::string text = !found.node.raw.empty() ? found.node.raw
                             : items.empty()
                                 ? found.node.found_text()
                                 : toml_list(items, [](const ConfigNode& item) { return item.found_text(); });
    return found.scene.complaints.add(found.node.where,
                                      {found.reader.full_name(found.name), text, found.allowed});
  }
  keys.material.permittivity_re = parts[0];
  keys.material.permittivity_im = parts[1];
}

std::string printed_permittivity(const MaterialKeys& keys, const SceneConfig&) {
  return toml_list(std::array{keys.material.permittivity_re, keys.material.permittivity_im}, toml_number);
}

const std::array kSpecial{
    special<MaterialKeys>(
        "permittivity", "", kAny, "[e', e''], e' 1 to 1e6 and the loss e'' 0 to 1e9, both without a sign",
        "Relative permittivity e' - j e'', of corners of walls and ground (buildings.corners).",
        read_permittivity, printed_permittivity, "[6.0, 0.6]"),
};

constexpr std::array kModels{Choice{"constant_gamma"}, Choice{"geometric_optics"}, Choice{"flat_plate"},
                             Choice{"sea"}};

constexpr std::array kRows{
    row<&MaterialKeys::material, &Material::model>(
        "model", kModels, "Scattering model; \"sea\" has constant gamma where sea.state is 0."),
    row<&MaterialKeys::gamma_db>(
        "gamma_db", "dB", closed(-200, 60),
        "Constant gamma; with geometric optics the floor away from the specular direction."),
    row<&MaterialKeys::material, &Material::reflectivity>(
        "reflectivity", closed(0, 1), "Geometric optics: power reflectivity at normal incidence."),
    row<&MaterialKeys::material, &Material::rms_slope>(
        "rms_slope", closed(0.001, 10),
        "Geometric optics: rms slope along one axis. Of ground before a wall (buildings.corners) as well, "
        "there 0.02 at least."),
    row<&MaterialKeys::material, &Material::plate_tau>("plate_tau", closed(0, 1e6),
                                                       "Flat plate: tau at normal incidence."),
    row<&MaterialKeys::material, &Material::plate_exponent>(
        "plate_exponent", closed(0, 1000), "Flat plate: tau falls as this power of cos(incidence)."),
    row<&MaterialKeys::material, &Material::wind>(
        "wind", kAny, "It moves in the wind (atmosphere.wind_m_s), as woods, shrubs and grass do."),
};

}  // namespace

std::span<const Row<MaterialKeys>> material_rows() { return kRows; }
std::span<const SpecialKey<MaterialKeys>> material_special_keys() { return kSpecial; }

std::vector<Material> shipped_materials() {
  return {diffuse("terrain", kFarmland_db),   building(),
          diffuse("ground", kFarmland_db),    water(),
          diffuse("urban", kMetropolitan_db), growing("forest", kWoods_db),
          diffuse("suburb", kSuburb_db),      growing("shrubs", kBushes_db),
          growing("grass", kGrass_db),        growing("marsh", kMarsh_db),
          diffuse("barren", kDesert_db)};
}

std::optional<std::size_t> find_material(const std::vector<Material>& materials, std::string_view name) {
  const auto found = std::ranges::find(materials, name, &Material::name);
  if (found == materials.end()) return std::nullopt;
  return static_cast<std::size_t>(found - materials.begin());
}

void read_materials(SceneReading& scene) {
  constexpr std::size_t kMost = 255;  // ids are bytes, and 255 is none (Labels)
  std::vector<Material>& materials = scene.config.materials;
  materials = shipped_materials();
  scene.top.one_table("materials", [&](const ConfigNode& all) {
    // By name, so that ids do not depend on whether a file or a flag named a material first.
    std::vector<ConfigNode> tables = all.items;
    std::ranges::sort(tables, {}, &ConfigNode::key);
    for (const ConfigNode& table : tables) {
      const std::string full_name = "materials." + toml_key(table.key);
      if (table.kind != ConfigNode::Kind::table || table.key.empty() || table.key.size() > 64 ||
          materials.size() >= kMost) {
        scene.complaints.add(table.where,
                             {full_name, table.found_text(), "a table [materials.NAME], 255 at most"});
        continue;
      }
      auto id = find_material(materials, table.key);
      if (!id) {
        id = materials.size();
        materials.push_back({});
        materials.back().name = table.key;
      }
      MaterialKeys keys{materials[*id], to_db(materials[*id].gamma)};
      SectionReader reader(table, full_name, scene.complaints);
      read_keys(scene, reader, {kRows, kSpecial}, "", keys);
      reader.finish();
      if (table.find("gamma_db") != nullptr) keys.material.gamma = from_db(keys.gamma_db);
      materials[*id] = keys.material;
    }
  });
}

void mark_used_materials(SceneConfig& config) {
  for (Material& material : config.materials) material.used = false;
  const auto use = [&config](std::uint8_t id) { config.materials.at(id).used = true; };
  const WorldSpec& world = config.world;
  use(0);  // ground that nothing else claims
  if (world.terrain.water_material) use(*world.terrain.water_material);
  for (const BuildingSourceSpec& buildings : world.buildings) use(buildings.material);
  for (const PrismSpec& prisms : world.prisms) use(prisms.material);
  for (const SurfaceSpec& surface : world.surfaces) {
    if (surface.scheme.empty()) use(surface.material);
    for (const auto& [value, id] : surface.scheme_materials) use(id);
  }
}

std::string printed_materials(const SceneConfig& config) {
  std::string text;
  for (const Material& m : config.materials)
    text += "\n[materials." + toml_key(m.name) + "]\n" +
            printed_keys<MaterialKeys>({kRows, kSpecial}, "", {m, to_db(m.gamma)}, config);
  return text;
}

void lower_building_floor(SceneReading& scene) {
  const ConfigNode* all = scene.top.table().find("materials");
  const ConfigNode* own = all != nullptr ? all->find("building") : nullptr;
  if (own != nullptr && own->find("gamma_db") != nullptr) return;
  std::vector<Material>& materials = scene.config.materials;
  if (const auto id = find_material(materials, "building"))
    materials[*id].gamma = from_db(kFloorBesideCorners_db);
}

double from_db(double decibel) { return std::pow(10.0, decibel / 10); }

double to_db(double ratio) {
  const double exact = 10 * std::log10(ratio);
  for (int digits = 1; digits <= 17; ++digits) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", digits, exact);
    const double rounded = std::strtod(text, nullptr);
    if (from_db(rounded) == ratio) return rounded;
  }
  for (double up = exact, down = exact; up < exact + 1e-9;) {  // the logarithm's own rounding
    up = std::nextafter(up, INFINITY);
    down = std::nextafter(down, -INFINITY);
    if (from_db(up) == ratio) return up;
    if (from_db(down) == ratio) return down;
    if (up - exact > 1e-13 * std::max(1.0, std::abs(exact))) break;
  }
  return exact;
}

}  // namespace obliq
