// The sweep's plane of zero width against Embree on the same mesh: rays in that plane meet the same triangles
// at the same ranges. Random terrains with voids, curvature and buildings, antennas above everything, below
// peaks and outside the grid, any bearing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "server/radar/profile/line_of_sight.h"
#include "server/scene/ray_answer.h"
#include "tests/support/figures.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq::sweep_embree_test {
namespace {

/// A visible piece between two elevations.
struct Seen {
  double low_rad;
  double high_rad;
  VisibleSegment piece;

  bool same_surface(const Seen& other) const {
    const VisibleSegment& a = piece;
    const VisibleSegment& b = other.piece;
    if (a.face != kNoFace || b.face != kNoFace) return a.face == b.face;
    return a.i == b.i && a.j == b.j && a.upper == b.upper;
  }
};

class Plane {
 public:
  Plane(const World& world, const glm::dvec3& antenna_m, double bearing_rad) {
    const SinCos bearing = sincos_turns(bearing_rad / (2 * M_PI));
    std::vector<RoofSpan> spans;
    for (std::uint32_t b = 0; b < world.buildings.list.size(); ++b)
      add_roof_spans(world.buildings, b, antenna_m.x, antenna_m.z, bearing.sin, bearing.cos, spans);
    LineOfSight plane(world, antenna_m, bearing, 0, HUGE_VAL, {}, spans);
    plane.advance(HUGE_VAL, *this);
  }

  void visible(const VisibleSegment& piece) {
    const auto elevation = [&](double t) { return std::atan2(piece.height_m(t), piece.ground_range_m(t)); };
    seen.push_back({elevation(piece.t0), elevation(piece.t1), piece});
  }
  static bool full() { return false; }

  /// The piece at an elevation, or nothing.
  const Seen* at(double elevation_rad) const {
    for (const Seen& s : seen)
      if (elevation_rad >= s.low_rad && elevation_rad < s.high_rad) return &s;
    return nullptr;
  }

  std::vector<Seen> seen;
};

bool same(const Seen* a, const Seen* b) { return a && b ? a->same_surface(*b) : a == b; }

/// Where the ray at an elevation meets the piece's line: (d, h) = (A + t D), h = d tan(e).
double range_m(const VisibleSegment& p, double elevation_rad) {
  const double s = std::sin(elevation_rad);
  const double c = std::cos(elevation_rad);
  const double t = (p.d_m * s - p.h_m * c) / (p.rate_h * c - p.rate_d * s);
  return std::hypot(p.ground_range_m(t), p.height_m(t));
}

/// Whether a hit lies on the piece's triangle.
bool on_triangle(const World& world, const VisibleSegment& piece, const ExactHit& hit) {
  if (piece.face != kNoFace || hit.face != kNoFace) return piece.face == hit.face;
  const double s = (hit.position_m.x - world.grid.node_x_m(piece.i)) / world.grid.cell_m;
  const double t = (hit.position_m.z - world.grid.node_z_m(piece.j)) / world.grid.cell_m;
  constexpr double kSlack = 1e-7;
  return s >= -kSlack && t >= -kSlack && s <= 1 + kSlack && t <= 1 + kSlack &&
         (piece.upper ? s + t >= 1 - kSlack : s + t <= 1 + kSlack);
}

/// Whether a ray passes below known ground before it ends.
bool below_ground(const World& world, const glm::dvec3& from, const glm::dvec3& direction, double range_m) {
  constexpr int kSteps = 2000;
  for (int step = 1; step < kSteps; ++step) {
    const glm::dvec3 at = from + (range_m * step / kSteps) * direction;
    if (world.grid.height_at_m(at.x, at.z) > at.y + 1e-6) return true;
  }
  return false;
}

struct Tally {
  int rays = 0, hits = 0, on_buildings = 0, excluded = 0, differ = 0, through_voids = 0;
  double worst_m = 0;
};

/// The distance from a number to the next float32.
double float_step(double value) {
  const auto f = static_cast<float>(std::abs(value));
  return static_cast<double>(std::nextafter(f, HUGE_VALF) - f);
}

void compare(const test::RandomScene& random, const Scene& scene, test::Dice& dice, Tally& tally) {
  constexpr int kPlanes = 3;
  constexpr int kRays = 32;
  const World& world = scene.world();
  const glm::dvec3& antenna = random.pose.antenna.m;
  for (int p = 0; p < kPlanes; ++p) {
    const double bearing = dice.uniform(-M_PI, M_PI);
    const Plane plane(world, antenna, bearing);
    if (plane.seen.empty()) continue;
    const double low = plane.seen.front().low_rad;
    const double high = plane.seen.back().high_rad + 0.02;
    std::vector<double> x(kRays), y(kRays), z(kRays), elevation(kRays);
    for (double& e : elevation) e = dice.uniform(low, high);
    std::sort(elevation.begin(), elevation.end());
    for (std::size_t k = 0; k < kRays; ++k) {
      const double c = std::cos(elevation[k]);
      x[k] = c * std::sin(bearing);
      y[k] = std::sin(elevation[k]);
      z[k] = c * std::cos(bearing);
    }
    std::vector<RoughHit> rough(kRays);
    scene.tracer().trace(antenna, x.data(), y.data(), z.data(), kRays, rough.data());
    for (std::size_t k = 0; k < kRays; ++k) {
      const auto hit = answer_ray(scene, antenna, {x[k], y[k], z[k]}, rough[k]).hit;
      const Seen* mine = plane.at(elevation[k]);
      ++tally.rays;
      // Turned by two float steps of range or coordinates any way, the ray must meet the same triangle.
      const double range = hit ? hit->slant_range_m : mine ? range_m(mine->piece, elevation[k]) : 100;
      const double step =
          std::max({float_step(range), float_step(antenna.x), float_step(antenna.z), float_step(antenna.y)});
      const double angle = 2 * step / range;
      const double turn = angle / std::max(1e-3, std::cos(elevation[k]));
      bool excluded =
          !same(mine, plane.at(elevation[k] + angle)) || !same(mine, plane.at(elevation[k] - angle));
      for (const double side : {-turn, turn}) {
        const Plane aside(world, antenna, bearing + side);
        for (const double off : {-angle, 0.0, angle})
          excluded = excluded || !same(mine, aside.at(elevation[k] + off));
      }
      if (excluded) {
        ++tally.excluded;
        continue;
      }
      // What stands behind a void's far edge is solid all the way down to the sweep (and to the reference
      // renderer); a ray may pass under the edge, and its answer is then the next ground that it meets from
      // above.
      if (!mine && hit && below_ground(world, antenna, {x[k], y[k], z[k]}, hit->slant_range_m)) {
        ++tally.through_voids;
        continue;
      }
      if ((mine != nullptr) != hit.has_value() || (mine && !on_triangle(world, mine->piece, *hit))) {
        if (++tally.differ <= 5)
          std::printf("    bearing %.9f elevation %.9f: sweep %s %.6f m, Embree %s %.6f m, in %s\n", bearing,
                      elevation[k], mine ? "sees" : "nothing",
                      mine ? range_m(mine->piece, elevation[k]) : 0.0, hit ? "hits" : "nothing",
                      hit ? hit->slant_range_m : 0.0, random.text.c_str());
        continue;
      }
      if (!mine) continue;
      ++tally.hits;
      tally.on_buildings += hit->face != kNoFace ? 1 : 0;
      const double off = std::abs(range_m(mine->piece, elevation[k]) - hit->slant_range_m);
      tally.worst_m = std::max(tally.worst_m, off);
    }
  }
}

Tally compare_scenes(std::uint64_t first, std::uint64_t count, const test::RandomSceneOptions& options) {
  Tally tally;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    test::RandomScene random = test::random_scene(seed, options);
    const auto scene = test::scene_of(random);
    test::Dice dice(seed);
    compare(random, *scene, dice, tally);
  }
  std::printf(
      "    %d rays, %d hits (%d on buildings), %d near edges and excluded (%.3f %%), %d on other "
      "triangles, %d under the edge of a void; ranges within %.1e m\n",
      tally.rays, tally.hits, tally.on_buildings, tally.excluded, 100.0 * tally.excluded / tally.rays,
      tally.differ, tally.through_voids, tally.worst_m);
  return tally;
}

TEST(SweepAndEmbree, MeetTheSameTrianglesAtTheSameRangesInThousandsOfScenes) {
  test::RandomSceneOptions options;
  options.far_origin = false;
  const Tally tally = compare_scenes(70000, 5000, options);
  test::record_figure("sweep_hits", tally.hits);
  test::record_figure("sweep_excluded", static_cast<double>(tally.excluded) / tally.rays);
  test::record_figure("sweep_worst_m", tally.worst_m);
  EXPECT_GT(tally.hits, 300000);
  EXPECT_GT(tally.on_buildings, 2000);
  // With the other diagonal, a horizon that starts at r_min, a roof that casts no shadow or a wall's wrong
  // face (the named wrong versions) thousands differ.
  EXPECT_EQ(tally.differ, 0);
  EXPECT_LE(tally.excluded, tally.rays / 1000);
  EXPECT_LE(tally.through_voids, tally.rays / 1000);
  EXPECT_LT(tally.worst_m, 1e-6);
}

}  // namespace
}  // namespace obliq::sweep_embree_test
