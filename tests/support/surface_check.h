#pragma once
// Whether what pixels hit is the surface, by brute force: shares no code with the tracer's intersections.
#include <gtest/gtest.h>

#include <cmath>
#include <mutex>

#include "server/radar/samples.h"
#include "server/scene/exact_hit.h"
#include "terrain/world.h"

namespace obliq::test {

/// The scene as heights: ground and roofs.
class SurfaceHeights {
 public:
  explicit SurfaceHeights(const World& world) : world_(world) {}

  /// y of the ground or of the highest roof over it; -infinity where neither is known.
  double top_m(double x_m, double z_m) const {
    double top = world_.grid.height_at_m(x_m, z_m);
    if (std::isnan(top)) top = -HUGE_VAL;
    const Buildings& all = world_.buildings;
    for (const Building& building : all.list) {
      bool inside = false;
      for_each_edge(building, [&](const glm::dvec2& p, const glm::dvec2& q) {
        if ((p.y > z_m) != (q.y > z_m) && x_m < p.x + (q.x - p.x) * (z_m - p.y) / (q.y - p.y))
          inside = !inside;
      });
      if (inside) top = std::max(top, static_cast<double>(building.roof_y_m));
    }
    return top;
  }

  /// Horizontal distance to the nearest wall that reaches the height y; infinite without one.
  double to_wall_m(const glm::dvec3& at_m) const {
    double nearest = HUGE_VAL;
    for (const Building& building : world_.buildings.list) {
      if (at_m.y > static_cast<double>(building.roof_y_m) + 1e-3) continue;
      if (at_m.y < static_cast<double>(building.base_y_m) - 1e-3) continue;
      for_each_edge(building, [&](const glm::dvec2& p, const glm::dvec2& q) {
        const glm::dvec2 along = q - p, to = glm::dvec2(at_m.x, at_m.z) - p;
        const double length2 = along.x * along.x + along.y * along.y;
        const double t = length2 > 0 ? std::clamp((to.x * along.x + to.y * along.y) / length2, 0.0, 1.0) : 0;
        nearest = std::min(nearest, std::hypot(to.x - t * along.x, to.y - t * along.y));
      });
    }
    return nearest;
  }

 private:
  template <class F>
  void for_each_edge(const Building& building, F&& f) const {
    const Buildings& all = world_.buildings;
    for (std::uint32_t ring = building.first_ring; ring < building.first_ring + building.n_rings; ++ring) {
      const std::uint32_t begin = all.ring_start[ring], end = all.ring_start[ring + 1];
      for (std::uint32_t k = begin; k < end; ++k)
        f(glm::dvec2(all.ring_xz_m[k]), glm::dvec2(all.ring_xz_m[k + 1 < end ? k + 1 : begin]));
    }
  }

  const World& world_;
};

/// Checks every hit of a frame: it lies on the ground, a roof or a wall, and no point of its ray before it
/// lies under the surface. Tolerance: a millimetre, which is what float32 coordinates of a few kilometres
/// (0.25 mm) leave of a wall's place; a ray that leaks passes by metres.
class HitsOnSurface : public HitObserver {
 public:
  HitsOnSurface(const World& world, const glm::dvec3& antenna_m) : surface_(world), antenna_m_(antenna_m) {}

  void on_hit(std::uint32_t pixel, double, const ExactHit& hit) override {
    constexpr double kTolerance_m = 1e-3;
    constexpr int kSteps = 100;
    const glm::dvec3& p = hit.position_m;
    bool good = std::isfinite(hit.slant_range_m) && hit.slant_range_m > 0 && hit.cos_incidence >= 0 &&
                hit.cos_incidence <= 1;
    // On a slope of 1,000 a millimetre aside is a metre up: the place may be off instead of the height.
    const bool on_top = std::abs(surface_.top_m(p.x, p.z) - p.y) < kTolerance_m || near_top(p, kTolerance_m);
    good = good && (on_top || surface_.to_wall_m(p) < kTolerance_m);
    for (int k = 0; good && k < kSteps; ++k) {
      const double share = (k + 0.5) / kSteps;
      const glm::dvec3 q = antenna_m_ + share * (p - antenna_m_);
      if (share * hit.slant_range_m > hit.slant_range_m - 0.1) break;
      good = surface_.top_m(q.x, q.z) < q.y + kTolerance_m || near_top(q, kTolerance_m);
    }
    const std::scoped_lock lock(mutex_);
    ++hits;
    if (good) return;
    if (++wrong <= 3)
      ADD_FAILURE() << "pixel " << pixel << ": hit at " << p.x << ", " << p.y << ", " << p.z << ", range "
                    << hit.slant_range_m << ", surface there at " << surface_.top_m(p.x, p.z);
  }

  int hits = 0;
  int wrong = 0;

 private:
  /// Whether the surface passes through the height of q within a millimetre of it.
  bool near_top(const glm::dvec3& q, double aside_m) const {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const auto& [dx, dz] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {0, 0}}) {
      const double top = surface_.top_m(q.x + dx * aside_m, q.z + dz * aside_m);
      low = std::min(low, top), high = std::max(high, top);
    }
    return low <= q.y + aside_m && high >= q.y - aside_m;
  }

  SurfaceHeights surface_;
  glm::dvec3 antenna_m_;
  std::mutex mutex_;
};

}  // namespace obliq::test
