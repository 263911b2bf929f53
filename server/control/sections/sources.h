#pragma once
// [terrain] with [terrain.shape], [earth]; [[buildings]], [[prisms]] and [[surfaces]].
#include "terrain/world_spec.h"

namespace obliq {

struct Section;
template <class T>
struct ListSection;

extern const ListSection<BuildingSourceSpec> kBuildings;
extern const ListSection<PrismSpec> kPrisms;
extern const ListSection<SurfaceSpec> kSurfaces;

extern const Section kTerrainSection;
extern const Section kShapeSection;
extern const Section kEarthSection;

}  // namespace obliq
