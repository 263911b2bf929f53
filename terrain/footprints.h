#pragma once
#include <optional>

#include "terrain/extrude.h"
#include "terrain/outline.h"
#include "terrain/vector_source.h"
#include "terrain/world.h"

namespace obliq {

/// Height of a building in metres: the named field, else "height", else "building:levels" storeys of 3 m.
/// Nothing when none of them holds a height between 0 and 2,000 m.
std::optional<double> feature_height_m(const VectorFeature& feature, const BuildingSourceSpec& spec);

/// A number that the outline keeps whatever point it starts at and whichever way round it runs, to 1e-7
/// degree (about 1 cm): tells duplicates and names faces.
std::uint64_t outline_identity(const GeoPolygon& polygon);

/// Reads all [[buildings]], stands them on world.grid and counts in world.report. Outlines are kept only when
/// all their corners lie inside the grid and the area's polygon. Throws InputError.
void load_buildings(World& world, const WorldSpec& spec, const Polygon& area, const Progress& progress);

/// True when all corners of the outer ring are inside the area, or there is no area.
bool lies_inside(const Polygon& area, const Polygon& outline);

/// Shapes, grounds and appends one polygon in world (x, z); returns how many prisms stand. Counts in the
/// report what becomes of it.
std::size_t stand_outline(World& world, OutlineShaper& shaper, const Polygon& polygon, const PrismLook& look);

}  // namespace obliq
