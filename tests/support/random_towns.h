#pragma once
// Random towns for property tests of the sweep: houses of every awkward shape within the swath of a radar
// with narrow bins, all from one seed.
#include "tests/support/random_scenes.h"

namespace obliq::test {

/// Ground: flat, hills, a cliff, ridges, a valley; one in five with voids. Houses: rectangles at any angle,
/// L, U, crosses, combs, rings with courtyards (some with a tower within), rows that share walls, towers on
/// podiums, rounds of many corners, slivers, needles of a centimetre, halls, the same outline twice; across
/// the cliff, across the swath's ends, around the antenna. Antenna: high, among the roofs, close to walls, on
/// a roof. Bins: from a tenth of a house to many houses wide; a few wider than a degree.
///
/// The frustum is the sweep with two planes in each azimuth bin.
RandomScene random_town(std::uint64_t seed);

}  // namespace obliq::test
