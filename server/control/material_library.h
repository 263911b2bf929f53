#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "server/scene/materials.h"

namespace obliq {

/// The materials that ship, by id: 0 "terrain" (ground that nothing else claims: farmland), 1 "building",
/// then "ground", "water", "urban", "forest", "suburb", "shrubs", "grass", "marsh" and "barren". A scene file
/// overrides them or adds its own behind them.
std::vector<Material> shipped_materials();

/// The id of a name in a list of materials.
std::optional<std::size_t> find_material(const std::vector<Material>& materials, std::string_view name);

double from_db(double decibel);

/// The decibel value, in as few digits as can be, that from_db turns into exactly this ratio where there is
/// one: so that a printed configuration reads back to the same bits.
double to_db(double ratio);

}  // namespace obliq
