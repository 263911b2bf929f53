#pragma once
#include <string>

#include "terrain/buildings/extrude.h"
#include "terrain/buildings/outline.h"
#include "terrain/buildings/vector_source.h"
#include "terrain/world.h"

namespace obliq {

/// A number that the outline keeps whatever point it starts at and whichever way round it runs, to 1e-7
/// degree (about 1 cm): tells duplicates and names faces.
std::uint64_t outline_identity(const GeoPolygon& polygon);

/// Wider outlines are districts or mistakes: the Klystron Gallery at SLAC, 3.07 km, is among the longest
/// buildings that there are. Dams and walls are longer still.
constexpr double kWidest_m = 8000;

/// Reads all [[buildings]], stands them on world.grid and counts in world.report. Outlines are kept only when
/// all their corners lie inside the grid and the area's polygon, and they are no wider than kWidest_m. Throws
/// InputError.
void load_buildings(World& world, const WorldSpec& spec, const Polygon& area, const Progress& progress);

/// True when all corners of the outer ring are inside the area, or there is no area.
bool lies_inside(const Polygon& area, const Polygon& outline);

/// Shapes, grounds and appends one polygon in world (x, z); returns how many prisms stand. Counts in the
/// report what becomes of it. `excess`, when given, is told what is too much of an outline that is too
/// complex.
std::size_t stand_outline(World& world, OutlineShaper& shaper, const Polygon& polygon, const PrismLook& look,
                          std::string* excess = nullptr);

}  // namespace obliq
