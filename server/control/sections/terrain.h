#pragma once
// [terrain] with [terrain.shape], and [earth].

namespace obliq {

struct Section;

extern const Section kTerrainSection;
extern const Section kShapeSection;
extern const Section kEarthSection;

}  // namespace obliq
