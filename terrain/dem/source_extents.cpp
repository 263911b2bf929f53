#include "terrain/dem/source_extents.h"

#include <fmt/core.h>

#include <GeographicLib/Geodesic.hpp>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "terrain/base/units.h"
#include "terrain/dem/dem_mosaic.h"
#include "terrain/dem/gdal_messages.h"

namespace obliq {
namespace {

constexpr double kDegree_m = kMeanEarthRadius_m * kDegree_rad;

/// Rings of equal area, and places on each, by which a disc is sampled.
constexpr int kRings = 6;
constexpr int kPlaces = 16;

}  // namespace

SourceExtents::Box SourceExtents::Box::around(std::span<const LonLat> points) {
  Box box;
  if (points.empty()) return box;
  // An edge runs on without jumps unless it crosses +-180: every point is brought near the first.
  const double first_deg = points.front().longitude_deg;
  double west = HUGE_VAL, east = -HUGE_VAL, plain_west = HUGE_VAL, plain_east = -HUGE_VAL;
  for (const LonLat& p : points) {
    const double near_deg = first_deg + std::remainder(p.longitude_deg - first_deg, 360.0);
    west = std::min(west, near_deg);
    east = std::max(east, near_deg);
    plain_west = std::min(plain_west, p.longitude_deg);
    plain_east = std::max(plain_east, p.longitude_deg);
    box.south_deg = std::min(box.south_deg, p.latitude_deg);
    box.north_deg = std::max(box.north_deg, p.latitude_deg);
  }
  // A file of more than half a turn cannot be brought near one of its corners.
  if (plain_east - plain_west > 180 && east - west > 180) {
    west = plain_west;
    east = plain_east;
  }
  box.middle_deg = (west + east) / 2;
  box.half_deg = (east - west) / 2;
  return box;
}

bool SourceExtents::Box::holds(const LonLat& place) const {
  return place.latitude_deg >= south_deg && place.latitude_deg <= north_deg &&
         std::abs(std::remainder(place.longitude_deg - middle_deg, 360.0)) <= half_deg;
}

LonLat SourceExtents::Box::nearest(const LonLat& place) const {
  const double east_deg = std::remainder(place.longitude_deg - middle_deg, 360.0);
  return {middle_deg + std::clamp(east_deg, -half_deg, half_deg),
          std::clamp(place.latitude_deg, south_deg, north_deg)};
}

void SourceExtents::add(std::span<const LonLat> edge) {
  if (!edge.empty()) boxes_.push_back(Box::around(edge));
}

void SourceExtents::cut_to(std::span<const LonLat> polygon) {
  const Box wanted = Box::around(polygon);
  std::vector<Box> left;
  for (Box box : boxes_) {
    const double off_deg = std::remainder(wanted.middle_deg - box.middle_deg, 360.0);
    const double west = std::max(-box.half_deg, off_deg - wanted.half_deg);
    const double east = std::min(box.half_deg, off_deg + wanted.half_deg);
    box.middle_deg += (west + east) / 2;
    box.half_deg = (east - west) / 2;
    box.south_deg = std::max(box.south_deg, wanted.south_deg);
    box.north_deg = std::min(box.north_deg, wanted.north_deg);
    if (box.half_deg >= 0 && box.south_deg <= box.north_deg) left.push_back(box);
  }
  boxes_ = std::move(left);
  what_ += " within terrain.area";
}

bool SourceExtents::covers(const LonLat& place) const {
  return everywhere_ || std::ranges::any_of(boxes_, [&](const Box& box) { return box.holds(place); });
}

bool SourceExtents::reaches(const LonLat& place, double radius_m) const {
  return everywhere_ || std::ranges::any_of(boxes_, [&](const Box& box) {
           const LonLat there = box.nearest(place);
           double distance_m = 0;
           GeographicLib::Geodesic::WGS84().Inverse(place.latitude_deg, place.longitude_deg,
                                                    there.latitude_deg, there.longitude_deg, distance_m);
           return distance_m <= radius_m;
         });
}

double SourceExtents::share(const LonLat& place, double radius_m) const {
  if (everywhere_) return 1;
  const double cos_latitude = std::max(0.01, std::cos(place.latitude_deg * kDegree_rad));
  int covered = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const double distance_deg = std::sqrt((ring + 0.5) / kRings) * radius_m / kDegree_m;
    for (int k = 0; k < kPlaces; ++k) {
      const double bearing_rad = 2 * std::numbers::pi * k / kPlaces;
      covered += covers({place.longitude_deg + distance_deg * std::sin(bearing_rad) / cos_latitude,
                         place.latitude_deg + distance_deg * std::cos(bearing_rad)});
    }
  }
  return static_cast<double>(covered) / (kRings * kPlaces);
}

SourceExtents source_extents(const TerrainSpec& terrain) {
  const GdalMessages quiet;
  return terrain.synthetic == SyntheticKind::none ? DemMosaic(terrain).extents() : SourceExtents();
}

std::string SourceExtents::text() const {
  if (boxes_.empty()) return what_ + " covers nothing";
  Box all = boxes_.front();
  double west = -all.half_deg, east = all.half_deg;
  for (const Box& box : boxes_) {
    const double off_deg = std::remainder(box.middle_deg - all.middle_deg, 360.0);
    west = std::min(west, off_deg - box.half_deg);
    east = std::max(east, off_deg + box.half_deg);
    all.south_deg = std::min(all.south_deg, box.south_deg);
    all.north_deg = std::max(all.north_deg, box.north_deg);
  }
  return fmt::format("{} covers longitude {:.4f} to {:.4f}, latitude {:.4f} to {:.4f}", what_,
                     all.middle_deg + west, all.middle_deg + east, all.south_deg, all.north_deg);
}

}  // namespace obliq
