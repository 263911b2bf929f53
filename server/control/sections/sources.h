#pragma once
// [terrain] with [terrain.shape], [earth]; [[buildings]], [[prisms]] and [[surfaces]].
#include <string>

#include "terrain/world_spec.h"

namespace obliq {

struct SceneConfig;
struct SceneReading;
struct Section;
template <class T>
struct ListSection;

extern const ListSection<BuildingSourceSpec> kBuildings;
extern const ListSection<PrismSpec> kPrisms;
extern const ListSection<SurfaceSpec> kSurfaces;

/// buildings.corners, one switch for all buildings of the scene: after materials and buildings are read.
void settle_corners(SceneReading& scene);
/// The default where no [[buildings]] table sets it.
std::string printed_corners(const SceneConfig& config);

extern const Section kTerrainSection;
extern const Section kShapeSection;
extern const Section kEarthSection;

}  // namespace obliq
