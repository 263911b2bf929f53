#pragma once
// How far the arithmetic of rays, profiles and bearings may be off, and is forgiven. A double has 2^-53
// = 1.1e-16 of its value; world coordinates stay below 2^20 m, so that a sum of a few of them is off by less
// than 1e-9 m.

namespace obliq {

/// Distances and heights along a profile that are worked out in two ways: their roundings, below 1e-9 m, over
/// a descent of a few thousandths. No building is surveyed to a micrometre.
constexpr double kTouching_m = 1e-6;

/// Ground distances that bound what is looked for: more than any rounding, and less than costs a cell.
constexpr double kMargin_m = 1e-3;

/// Bearings of places a metre or more from the antenna: coordinates off by 1e-9 m at most, atan2 by 4e-16.
constexpr double kMargin_rad = 1e-9;

/// Slopes and sidesteps, height or width over ground distance: as bearings.
constexpr double kSlopeMargin = 1e-9;

/// Crossings of a profile with the grid's lines, in cells, of which a grid has less than 2^16 a side: off by
/// 2^-36, so that one at an end of a stretch counts however it is rounded.
constexpr double kCrossingMargin_cells = 1e-9;

/// How far outside its ground triangle, in x or z, a double point still counts as inside: a point on a shared
/// edge must be inside at least one of its two triangles, whatever the rounding (2^-52 of coordinates up to
/// 2^20 m, over a descent of a few thousandths, is below it). Not relative to the cell: beyond the edge the
/// range is the wrong plane's, by this length times the change of slope over the descent.
constexpr double kGroundEdge_m = 1e-7;

/// The same for building triangles, in barycentric units; beyond an edge between two triangles of one face
/// the plane is the same.
constexpr double kFaceEdge = 1e-7;

/// How deep inside a solid a hit must lie to prove a leak. Hits on a wall's foot or where buildings touch are
/// on both surfaces, to rounding; a leak is deeper by the thickness of what it passed.
constexpr double kLeakDepth_m = 1e-3;

}  // namespace obliq
