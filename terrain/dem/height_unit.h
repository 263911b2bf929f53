#pragma once
#include <optional>
#include <string>

#include "terrain/dem/raster.h"
#include "terrain/world_spec.h"

namespace obliq {

/// Unit of a raster's heights.
struct HeightUnit {
  double metres = 1;     ///< one unit in metres
  std::string name;      ///< as the file or the scene has it
  bool assumed = false;  ///< not named: metres
};

/// The given unit, else the band's, else its vertical system's, else metres. Throws InputError on a unit that
/// is not a length we know.
HeightUnit height_unit(const Raster& raster, const std::optional<VerticalUnit>& unit);

}  // namespace obliq
