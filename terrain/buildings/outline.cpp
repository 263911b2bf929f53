#include "terrain/buildings/outline.h"

#include <fmt/core.h>
#include <geos_c.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "terrain/buildings/clip_ears.h"
#include "terrain/polygon.h"

namespace obliq {
namespace {

double signed_area(const FloatRing& ring) {
  Ring exact;
  exact.reserve(ring.size());
  for (glm::vec2 p : ring) exact.emplace_back(p);
  return signed_area_m2(exact);
}

void drop_repeats(FloatRing& ring) {
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
}

/// Sign of the turn a -> b -> c on a map: positive is to the left.
double turn(glm::vec2 a, glm::vec2 b, glm::vec2 c) {
  const glm::dvec2 u = glm::dvec2(b) - glm::dvec2(a);
  const glm::dvec2 v = glm::dvec2(c) - glm::dvec2(b);
  return u.x * v.y - u.y * v.x;
}

/// True for one ring that turns left everywhere and goes around once: valid, and a fan cuts it.
bool is_convex(const FloatRings& rings) {
  if (rings.size() != 1) return false;
  const FloatRing& r = rings[0];
  const std::size_t n = r.size();
  int changes = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::vec2 a = r[i], b = r[(i + 1) % n], c = r[(i + 2) % n];
    if (!(turn(a, b, c) > 0)) return false;
    // Around once means that x rises and falls once.
    if (((b.x > a.x) || (b.x == a.x && b.y > a.y)) != ((c.x > b.x) || (c.x == b.x && c.y > b.y))) ++changes;
  }
  return changes == 2;
}

}  // namespace

struct OutlineShaper::Geos {
  GEOSContextHandle_t handle = GEOS_init_r();
  GEOSMakeValidParams* repair = nullptr;

  struct Destroy {
    GEOSContextHandle_t handle;
    void operator()(GEOSGeometry* g) const { GEOSGeom_destroy_r(handle, g); }
  };
  using Geometry = std::unique_ptr<GEOSGeometry, Destroy>;

  Geos() {
    repair = GEOSMakeValidParams_create_r(handle);
    GEOSMakeValidParams_setMethod_r(handle, repair, GEOS_MAKE_VALID_STRUCTURE);
    GEOSMakeValidParams_setKeepCollapsed_r(handle, repair, 0);
  }
  ~Geos() {
    GEOSMakeValidParams_destroy_r(handle, repair);
    GEOS_finish_r(handle);
  }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;

  Geometry own(GEOSGeometry* g) const { return Geometry(g, Destroy{handle}); }

  GEOSGeometry* linear_ring(const FloatRing& ring) const {
    std::vector<double> buffer;
    for (glm::vec2 p : ring) {
      buffer.push_back(static_cast<double>(p.x));
      buffer.push_back(static_cast<double>(p.y));
    }
    buffer.push_back(buffer[0]);
    buffer.push_back(buffer[1]);
    GEOSCoordSequence* points =
        GEOSCoordSeq_copyFromBuffer_r(handle, buffer.data(), static_cast<unsigned>(ring.size() + 1), 0, 0);
    return points ? GEOSGeom_createLinearRing_r(handle, points) : nullptr;
  }

  Geometry polygon(const FloatRings& rings) const {
    std::vector<GEOSGeometry*> holes;
    for (std::size_t k = 1; k < rings.size(); ++k) {
      if (GEOSGeometry* hole = linear_ring(rings[k])) holes.push_back(hole);
    }
    GEOSGeometry* shell = linear_ring(rings[0]);
    if (!shell) {
      for (GEOSGeometry* hole : holes) GEOSGeom_destroy_r(handle, hole);
      return own(nullptr);
    }
    return own(GEOSGeom_createPolygon_r(handle, shell, holes.data(), static_cast<unsigned>(holes.size())));
  }

  FloatRing ring_points(const GEOSGeometry* ring) const {
    const GEOSCoordSequence* points = GEOSGeom_getCoordSeq_r(handle, ring);
    unsigned n = 0;
    FloatRing result;
    if (!points || !GEOSCoordSeq_getSize_r(handle, points, &n)) return result;
    for (unsigned i = 0; i < n; ++i) {
      double x = 0, y = 0;
      GEOSCoordSeq_getXY_r(handle, points, i, &x, &y);
      result.emplace_back(static_cast<float>(x), static_cast<float>(y));
    }
    drop_repeats(result);
    return result;
  }

  /// Every polygon in a geometry, as rounded rings without those that collapse.
  void collect(const GEOSGeometry* g, std::vector<FloatRings>& polygons) const {
    const int type = GEOSGeomTypeId_r(handle, g);
    if (type == GEOS_POLYGON) {
      if (GEOSisEmpty_r(handle, g) != 0) return;
      FloatRings rings{ring_points(GEOSGetExteriorRing_r(handle, g))};
      if (rings[0].size() < 3) return;
      const int holes = GEOSGetNumInteriorRings_r(handle, g);
      for (int k = 0; k < holes; ++k) {
        FloatRing hole = ring_points(GEOSGetInteriorRingN_r(handle, g, k));
        if (hole.size() >= 3) rings.push_back(std::move(hole));
      }
      polygons.push_back(std::move(rings));
    } else if (type == GEOS_MULTIPOLYGON || type == GEOS_GEOMETRYCOLLECTION) {
      const int n = GEOSGetNumGeometries_r(handle, g);
      for (int k = 0; k < n; ++k) collect(GEOSGetGeometryN_r(handle, g, k), polygons);
    }
  }

  /// Splits a polygon into valid ones. Rounding a repair's new corners to float32 may make new crossings, so
  /// a repair is looked at again; what three rounds do not cure is dropped.
  /// What needs a repair and has more crossings than are allowed is too complex.
  std::vector<FloatRings> valid_parts(const FloatRings& rings, OutlineState& state) const;

  /// Triangles of a valid polygon, as indices into all points of all rings; empty where GEOS does not find
  /// them.
  std::vector<glm::uvec3> triangles(const FloatRings& rings) const;
};

std::vector<FloatRings> OutlineShaper::Geos::valid_parts(const FloatRings& rings, OutlineState& state) const {
  std::vector<FloatRings> valid;
  std::vector<FloatRings> open{rings};
  for (int round = 0; round < 3 && !open.empty(); ++round) {
    std::vector<FloatRings> next;
    for (FloatRings& part : open) {
      const Geometry given = polygon(part);
      if (!given) continue;
      if (GEOSisValid_r(handle, given.get()) == 1) {
        valid.push_back(std::move(part));
        continue;
      }
      if (count_crossings(part, OutlineShaper::kMostCrossings + 1) > OutlineShaper::kMostCrossings) {
        state = OutlineState::too_complex;
        return {};
      }
      state = OutlineState::repaired;
      const Geometry mended = own(GEOSMakeValidWithParams_r(handle, given.get(), repair));
      if (mended) collect(mended.get(), next);
    }
    open = std::move(next);
  }
  return valid;
}

std::vector<glm::uvec3> OutlineShaper::Geos::triangles(const FloatRings& rings) const {
  std::vector<std::pair<glm::vec2, unsigned>> index;
  for (const FloatRing& ring : rings) {
    for (glm::vec2 p : ring) index.emplace_back(p, static_cast<unsigned>(index.size()));
  }
  const auto before = [](glm::vec2 a, glm::vec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
  std::sort(index.begin(), index.end(),
            [&](const auto& a, const auto& b) { return before(a.first, b.first); });
  const Geometry whole = polygon(rings);
  const Geometry pieces = own(whole ? GEOSConstrainedDelaunayTriangulation_r(handle, whole.get()) : nullptr);
  if (!pieces) return {};
  std::vector<glm::uvec3> found;
  const int n = GEOSGetNumGeometries_r(handle, pieces.get());
  for (int k = 0; k < n; ++k) {
    const FloatRing corners =
        ring_points(GEOSGetExteriorRing_r(handle, GEOSGetGeometryN_r(handle, pieces.get(), k)));
    if (corners.size() != 3) return {};
    glm::uvec3 triangle(0);
    for (int c = 0; c < 3; ++c) {
      const auto at = std::lower_bound(index.begin(), index.end(), corners[static_cast<std::size_t>(c)],
                                       [&](const auto& a, glm::vec2 b) { return before(a.first, b); });
      if (at == index.end() || at->first != corners[static_cast<std::size_t>(c)]) return {};
      triangle[c] = at->second;
    }
    found.push_back(triangle);
  }
  return found;
}

namespace {

/// False when the triangles do not make up the whole.
bool take_roof(std::vector<glm::uvec3> triangles, Outline& outline) {
  std::vector<glm::vec2> points;
  for (const FloatRing& ring : outline.rings_m) points.insert(points.end(), ring.begin(), ring.end());
  double sum = 0;
  glm::dvec2 moment(0.0);
  for (glm::uvec3& t : triangles) {
    const glm::vec2 a = points[t.x], b = points[t.y], c = points[t.z];
    const double area = turn(a, b, c) / 2;
    if (area > 0) std::swap(t.y, t.z);
    sum += std::abs(area);
    moment += std::abs(area) / 3 * (glm::dvec2(a) + glm::dvec2(b) + glm::dvec2(c));
  }
  outline.roof = std::move(triangles);
  outline.centre_m = moment / sum;
  // The pieces share the polygon's own points, so areas agree to rounding unless a piece is missing.
  return std::abs(sum - outline.area_m2) <= 1e-6 * outline.area_m2 + 1e-9;
}

/// GEOS looks for a triangle's neighbours in boxes around sixteen corners in a row. Where an outline winds,
/// each box has all the others in it, and time grows with the cube of the corners: 20 s for 4,000, 0.05 s for
/// this many.
constexpr std::size_t kMostByGeos = 512;

std::size_t count_corners(const FloatRings& rings) {
  std::size_t corners = 0;
  for (const FloatRing& ring : rings) corners += ring.size();
  return corners;
}

}  // namespace

OutlineShaper::OutlineShaper() : geos_(std::make_unique<Geos>()) {}
OutlineShaper::~OutlineShaper() = default;

namespace {

/// Turns rings the right way round and measures; false when there is no area.
bool orient(FloatRings& rings, Outline& outline) {
  double area = 0;
  for (std::size_t k = 0; k < rings.size(); ++k) {
    const double own = signed_area(rings[k]);
    if ((own > 0) != (k == 0)) std::reverse(rings[k].begin(), rings[k].end());
    area += k == 0 ? std::abs(own) : -std::abs(own);
  }
  outline.area_m2 = area;
  return area >= OutlineShaper::kLeastArea_m2;
}

/// The rings in float32, those that collapse left out.
OutlineState rounded_rings(const Polygon& polygon, FloatRings& rings) {
  for (std::size_t k = 0; k < polygon.rings.size(); ++k) {
    FloatRing rounded;
    for (glm::dvec2 p : polygon.rings[k]) {
      rounded.emplace_back(p);
      if (!std::isfinite(rounded.back().x) || !std::isfinite(rounded.back().y)) return OutlineState::unusable;
    }
    drop_repeats(rounded);
    if (rounded.size() >= 3) {
      rings.push_back(std::move(rounded));
    } else if (k == 0) {
      return polygon.rings[k].size() < 3 ? OutlineState::unusable : OutlineState::zero_area;
    }
  }
  return rings.empty() ? OutlineState::unusable : OutlineState::good;
}

void fan(Outline& outline) {
  const FloatRing& ring = outline.rings_m[0];
  glm::dvec2 moment(0.0);
  for (unsigned k = 1; k + 1 < ring.size(); ++k) {
    outline.roof.emplace_back(0, k + 1, k);
    const double area = turn(ring[0], ring[k], ring[k + 1]) / 2;
    moment += area / 3 * (glm::dvec2(ring[0]) + glm::dvec2(ring[k]) + glm::dvec2(ring[k + 1]));
  }
  outline.centre_m = moment / outline.area_m2;
}

}  // namespace

std::string excess_corners(std::size_t corners) {
  if (corners <= OutlineShaper::kMostCorners) return {};
  return fmt::format("{} corners; allowed: {}", corners, OutlineShaper::kMostCorners);
}

ShapedOutline OutlineShaper::shape(const Polygon& polygon) {
  ShapedOutline shaped;
  std::size_t corners = 0;
  for (const Ring& ring : polygon.rings) corners += ring.size();
  shaped.excess = excess_corners(corners);
  if (!shaped.excess.empty()) {
    shaped.state = OutlineState::too_complex;
    return shaped;
  }
  FloatRings rings;
  shaped.state = rounded_rings(polygon, rings);
  if (shaped.state != OutlineState::good) return shaped;

  Outline whole;
  const bool has_area = orient(rings, whole);
  if (has_area && is_convex(rings)) {
    whole.rings_m = std::move(rings);
    fan(whole);
    whole.parts = convex_parts(whole.rings_m, whole.roof);
    shaped.parts.push_back(std::move(whole));
    shaped.state = OutlineState::good;
    return shaped;
  }
  bool failed = false;
  const std::vector<FloatRings> parts = geos_->valid_parts(rings, shaped.state);
  if (shaped.state == OutlineState::too_complex) {
    shaped.excess = fmt::format("more than {} places where its edges cross or touch; allowed: {}",
                                kMostCrossings, kMostCrossings);
    return shaped;
  }
  for (FloatRings part : parts) {
    Outline outline;
    if (!orient(part, outline)) continue;
    outline.rings_m = std::move(part);
    const bool many = count_corners(outline.rings_m) > kMostByGeos;
    if ((many && take_roof(clip_ears(outline.rings_m), outline)) ||
        take_roof(geos_->triangles(outline.rings_m), outline)) {
      outline.parts = convex_parts(outline.rings_m, outline.roof);
      shaped.parts.push_back(std::move(outline));
    } else {
      failed = true;
    }
  }
  if (shaped.parts.empty()) shaped.state = failed ? OutlineState::unusable : OutlineState::zero_area;
  return shaped;
}

}  // namespace obliq
