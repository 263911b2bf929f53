#include "terrain/grid_area.h"

#include <fmt/core.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// A meridian or parallel leaves its chord by s^2 / 8R tan(latitude): a few centimetres on this length.
constexpr double kLongestAreaEdge_deg = 0.01;

/// Node coordinates on the quantum are exact in float32 up to here.
constexpr double kFurthest_m = 0x1p19;

void require_position(const LonLat& p, const char* field) {
  if (std::isfinite(p.longitude_deg) && std::isfinite(p.latitude_deg) && std::abs(p.latitude_deg) <= 90 &&
      std::abs(p.longitude_deg) <= 540)
    return;
  throw InputError(FieldError{field,
                              fmt::format("longitude {}, latitude {}", p.longitude_deg, p.latitude_deg),
                              "a longitude in -180..180 and a latitude in -90..90 degrees"}
                       .text());
}

/// The area's outline with edges straight in longitude and latitude, as a map draws them.
Ring area_ring(const std::vector<LonLat>& area, const WorldFrame& frame) {
  Ring ring;
  for (std::size_t i = 0; i < area.size(); ++i) {
    const LonLat a = area[i];
    const LonLat b = area[(i + 1) % area.size()];
    const double span_deg =
        std::max(std::abs(b.longitude_deg - a.longitude_deg), std::abs(b.latitude_deg - a.latitude_deg));
    const int n = std::max(1, static_cast<int>(std::ceil(span_deg / kLongestAreaEdge_deg)));
    for (int k = 0; k < n; ++k) {
      const double t = static_cast<double>(k) / n;
      ring.push_back(world_xz_m(frame, {a.longitude_deg + t * (b.longitude_deg - a.longitude_deg),
                                        a.latitude_deg + t * (b.latitude_deg - a.latitude_deg)}));
    }
  }
  return ring;
}

/// Room for `n` values, in pages of 2 MiB where the kernel has them to give (madvise(2), MADV_HUGEPAGE): a
/// march crosses the rows of a large array, and each row would have a page of its own. For an empty vector,
/// before it is filled.
template <class T>
void reserve_in_huge_pages(std::vector<T>& values, std::size_t n) {
  constexpr std::uintptr_t kPage = std::uintptr_t{2} << 20;
  values.reserve(n);
  const auto begin = (reinterpret_cast<std::uintptr_t>(values.data()) + kPage - 1) & ~(kPage - 1);
  const auto end = reinterpret_cast<std::uintptr_t>(values.data() + n) & ~(kPage - 1);
  if (end > begin) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace

bool WantedArea::contains(glm::dvec2 p) const {
  if (!polygon.rings.empty()) return polygon.contains(p);
  return std::any_of(discs.begin(), discs.end(), [&](const Disc& d) {
    return std::hypot(p.x - d.centre_m.x, p.y - d.centre_m.y) <= d.radius_m;
  });
}

glm::dvec2 world_xz_m(const WorldFrame& frame, const LonLat& position) {
  const WorldPoint p = frame.world_from_geodetic(
      {position.latitude_deg * kDegree_rad, position.longitude_deg * kDegree_rad, 0});
  return {p.m.x, p.m.z};
}

WantedArea wanted_area(const WorldSpec& spec, const WorldFrame& frame) {
  WantedArea wanted;
  if (!spec.terrain.area.empty()) {
    for (const LonLat& p : spec.terrain.area) require_position(p, "[terrain] area");
    if (spec.terrain.area.size() < 3)
      throw InputError(fmt::format("[terrain] area: found {} points; allowed: a polygon of at least 3",
                                   spec.terrain.area.size()));
    wanted.polygon.rings.push_back(area_ring(spec.terrain.area, frame));
    wanted.rect = bounds(wanted.polygon);
    if (!(std::abs(signed_area_m2(wanted.polygon.rings[0])) > 0))
      throw InputError("[terrain] area: found a polygon of no area; allowed: a polygon that encloses ground");
    return wanted;
  }
  for (const Reach& reach : spec.reaches) {
    require_position(reach.centre, "antenna position");
    if (!(reach.radius_m > 0) || !std::isfinite(reach.radius_m)) {
      throw InputError(
          FieldError{"radar reach", fmt::format("{} m", reach.radius_m), "a positive number of metres"}
              .text());
    }
    const glm::dvec2 c = world_xz_m(frame, reach.centre);
    wanted.discs.push_back({c, reach.radius_m});
    wanted.rect.include({c.x - reach.radius_m, c.y - reach.radius_m});
    wanted.rect.include({c.x + reach.radius_m, c.y + reach.radius_m});
  }
  return wanted;
}

double round_to_quantum_m(double length_m) {
  return std::max(1.0, std::round(length_m / kGridQuantum_m)) * kGridQuantum_m;
}

HeightGrid empty_grid(const Rect& rect, double cell_m) {
  if (!(cell_m > 0) || !std::isfinite(cell_m))
    throw InputError(
        fmt::format("[terrain] cell_m: found {}; allowed: a positive number of metres or \"auto\"", cell_m));
  const double furthest_m =
      std::max({-rect.x0_m, -rect.z0_m, rect.x1_m, rect.z1_m, std::abs(rect.x0_m), std::abs(rect.z0_m)});
  if (!(furthest_m <= kFurthest_m))
    throw InputError(fmt::format(
        "[terrain] area: found ground {:.1f} km from the scene's origin; allowed: at most 524 km, so "
        "give an area or a shorter range",
        furthest_m / 1000));
  // Nodes are multiples of the cell, so that another window has the same nodes where the two overlap.
  const double i0 = std::ceil(rect.x0_m / cell_m);
  const double j0 = std::ceil(rect.z0_m / cell_m);
  const double nx = std::floor(rect.x1_m / cell_m) - i0 + 1;
  const double nz = std::floor(rect.z1_m / cell_m) - j0 + 1;
  if (!(nx * nz <= kMaxNodes) || nx > 0x1p30 || nz > 0x1p30)
    throw InputError(
        fmt::format("[terrain] cell_m and area: found {:.1f} million nodes of {} m; allowed: at most 268 "
                    "million, so make cell_m larger or the area smaller",
                    nx * nz / 1e6, cell_m));
  if (nx < 2 || nz < 2)
    throw InputError(
        fmt::format("[terrain] cell_m and area: found fewer than 2 x 2 nodes of {} m in the area that is "
                    "covered; allowed: a smaller cell_m or a larger area",
                    cell_m));
  HeightGrid grid;
  grid.x0_m = i0 * cell_m;
  grid.z0_m = j0 * cell_m;
  grid.cell_m = cell_m;
  grid.nx = static_cast<int>(nx);
  grid.nz = static_cast<int>(nz);
  const std::size_t nodes = static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.nz);
  reserve_in_huge_pages(grid.y_m, nodes);
  grid.y_m.assign(static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.nz),
                  std::numeric_limits<float>::quiet_NaN());
  return grid;
}

void cut_to_polygon(HeightGrid& grid, const Polygon& polygon) {
  if (polygon.rings.empty()) return;
  std::vector<double> x_m;
  for (int j = 0; j < grid.nz; ++j) {
    crossings(polygon, grid.node_z_m(j), x_m);
    std::size_t next = 0;
    for (int i = 0; i < grid.nx; ++i) {
      while (next < x_m.size() && x_m[next] <= grid.node_x_m(i)) ++next;
      if (next % 2 == 0) grid.y_m[grid.index(i, j)] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

double covered_fraction(const HeightGrid& grid, const WantedArea& wanted) {
  constexpr int kSide = 256;
  const Rect& r = wanted.rect;
  int asked = 0;
  int known = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const glm::dvec2 p(r.x0_m + (r.x1_m - r.x0_m) * (i + 0.5) / kSide,
                         r.z0_m + (r.z1_m - r.z0_m) * (j + 0.5) / kSide);
      if (!wanted.contains(p)) continue;
      ++asked;
      if (!std::isnan(grid.height_at_m(p.x, p.y))) ++known;
    }
  }
  return asked == 0 ? 1.0 : static_cast<double>(known) / asked;
}

}  // namespace obliq
