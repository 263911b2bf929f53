#include "server/control/sections/land_cover.h"

namespace obliq {

namespace {

// What each class is made of; material_library.cpp has the values and their sources. Classes that a table
// does not name go with the nearest that it does, as said; snow and ice return from -20 to +5 dB with their
// wetness, so that one number would be made up.

// MRLC, National Land Cover Database class legend and description, 2021.
const std::vector<LandCoverClass> kNlcd = {
    {11, "water"},   // open water
    {12, ""},        // perennial ice and snow
    {21, "grass"},   // developed, open space: lawns, less than 20 % of it built
    {22, "suburb"},  // developed, low intensity: houses
    {23, "suburb"},  // developed, medium intensity: houses
    {24, "urban"},   // developed, high intensity: blocks, commerce, industry
    {31, "barren"},  // rock, sand, clay
    {41, "forest"},  // deciduous
    {42, "forest"},  // evergreen
    {43, "forest"},  // mixed
    {51, "shrubs"},  // dwarf scrub
    {52, "shrubs"},  // shrub, scrub
    {71, "grass"},   // grassland
    {72, "grass"},   // sedge
    {73, "barren"},  // lichens: on rock
    {74, "grass"},   // moss
    {81, "grass"},   // pasture, hay
    {82, "ground"},  // cultivated crops: farmland
    {90, "forest"},  // woody wetlands: the canopy returns
    {95, "marsh"},   // emergent herbaceous wetlands
};

// ESA WorldCover 10 m product user manual, version 2.0, 2022.
const std::vector<LandCoverClass> kWorldCover = {
    {10, "forest"},   // tree cover
    {20, "shrubs"},   // shrubland
    {30, "grass"},    // grassland
    {40, "ground"},   // cropland: farmland
    {50, "urban"},    // built-up
    {60, "barren"},   // bare, sparse vegetation
    {70, ""},         // snow and ice
    {80, "water"},    // permanent water bodies
    {90, "marsh"},    // herbaceous wetland
    {95, "forest"},   // mangroves
    {100, "barren"},  // moss and lichen: on rock, tundra
};

}  // namespace

std::optional<std::vector<LandCoverClass>> land_cover(std::string_view scheme) {
  if (scheme == kLandCoverSchemes[0].name) return kNlcd;
  if (scheme == kLandCoverSchemes[1].name) return kWorldCover;
  return std::nullopt;
}

}  // namespace obliq
