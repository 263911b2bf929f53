#pragma once
// [materials.NAME], and the materials that ship.
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/control/row.h"
#include "server/scene/materials.h"

namespace obliq {

struct SceneConfig;
struct SceneReading;
template <class T>
struct SpecialKey;

/// The materials that ship, by id: 0 "terrain" (ground that nothing else claims: farmland), 1 "building",
/// then "ground", "water", "urban", "forest", "suburb", "shrubs", "grass", "marsh" and "barren". A scene file
/// overrides them or adds its own behind them.
std::vector<Material> shipped_materials();

/// The id of a name in a list of materials.
std::optional<std::size_t> find_material(const std::vector<Material>& materials, std::string_view name);

/// What [materials.NAME] sets of a material; gamma in decibel.
struct MaterialKeys {
  Material material;
  double gamma_db = 0;
};
std::span<const Row<MaterialKeys>> material_rows();
std::span<const SpecialKey<MaterialKeys>> material_special_keys();

/// [materials.*]; before the sections that name materials.
void read_materials(SceneReading& scene);
/// Finds out which are used, when all that names them has been read.
void mark_used_materials(SceneConfig& config);
std::string printed_materials(const SceneConfig& config);
/// Where corners are reckoned the floor of "building", which stands for them without, falls; unless the scene
/// says what it is.
void lower_building_floor(SceneReading& scene);

double from_db(double decibel);

/// The decibel value, in as few digits as can be, that from_db turns into exactly this ratio where there is
/// one: so that a printed configuration reads back to the same bits.
double to_db(double ratio);

}  // namespace obliq
