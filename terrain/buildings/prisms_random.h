#pragma once
// Random rectangular buildings inside given polygons, as the paper scatters them.
//
// The earth is divided into cells of equal area, one candidate in each: rows of latitude 1 / sqrt(density) km
// high, cut into steps of longitude of the same width. Everything about a candidate (place in its cell,
// sides, height, direction) is a hash of the seed, its row and its column, so the same town stands whatever
// part of it is loaded and wherever the scene's origin is.
#include "terrain/polygon.h"
#include "terrain/world.h"

namespace obliq {

/// A candidate before it is known whether it stands in a polygon.
struct PrismCandidate {
  LonLat centre;
  double width_m = 0;
  double length_m = 0;
  double height_m = 0;
  double bearing_rad = 0;  ///< of its length
  std::uint64_t identity = 0;
};

/// Cells of one density.
class PrismCells {
 public:
  explicit PrismCells(const PrismSpec& spec);

  std::int64_t row_of(double latitude_deg) const;
  std::int64_t column_of(std::int64_t row, double longitude_deg) const;
  PrismCandidate candidate(std::int64_t row, std::int64_t column) const;
  double row_south_deg(std::int64_t row) const { return static_cast<double>(row) * step_deg_; }

 private:
  double column_step_deg(std::int64_t row) const;

  PrismSpec spec_;
  double side_m_ = 0;
  double step_deg_ = 0;
};

/// Scatters all [[prisms]] over the loaded ground. Throws InputError.
void scatter_prisms(World& world, const WorldSpec& spec, const Polygon& area, const Progress& progress);

}  // namespace obliq
