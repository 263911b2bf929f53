#pragma once
// [[buildings]], [[prisms]] and [[surfaces]]: what stands and lies on the terrain.
#include "terrain/world_spec.h"

namespace obliq {

template <class T>
struct ListSection;

extern const ListSection<BuildingSourceSpec> kBuildings;
extern const ListSection<PrismSpec> kPrisms;
extern const ListSection<SurfaceSpec> kSurfaces;

}  // namespace obliq
