// Hard case 9: the same rays through Embree's SSE4.2, AVX, AVX2 and AVX-512 kernels. What a ray meets is the
// same to the bit, but for rays that pass a triangle's edge within float steps: there two kernels may round
// to different sides. Ranges come from the triangle's plane in double, so that either answer is exact for the
// surface that it names.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <glm/geometric.hpp>
#include <unordered_map>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/radar/samples.h"
#include "server/scene/embree_tracer.h"
#include "server/scene/exact_hit.h"
#include "terrain/buildings/building_mesh.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

class Hits : public HitObserver {
 public:
  void on_hit(std::uint32_t pixel, double, const ExactHit& hit) override { of_pixel_[pixel] = hit; }
  const std::unordered_map<std::uint32_t, ExactHit>& all() const { return of_pixel_; }

 private:
  std::unordered_map<std::uint32_t, ExactHit> of_pixel_;
};

/// How far a hit lies from the nearest edge of its own surface's triangles: grid lines and diagonals, or
/// walls' and roofs' outlines.
double from_edge_m(const World& world, const ExactHit& hit) {
  const glm::dvec3& p = hit.position_m;
  if (hit.face == kNoFace) {
    const double u = (p.x - world.grid.x0_m) / world.grid.cell_m;
    const double v = (p.z - world.grid.z0_m) / world.grid.cell_m;
    const double nearest = std::min({std::abs(u - std::round(u)), std::abs(v - std::round(v)),
                                     std::abs(u + v - std::round(u + v)) / std::sqrt(2.0)});
    return nearest * world.grid.cell_m;
  }
  double nearest = HUGE_VAL;
  const Buildings& all = world.buildings;
  const Building& b = all.list[all.faces[hit.face].building];
  for_each_triangle(all, b, [&](std::uint32_t, const Triangle& triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 a(triangle[k]);
      const glm::dvec3 edge = glm::dvec3(triangle[(k + 1) % 3]) - a;
      const double along = std::clamp(glm::dot(p - a, edge) / glm::dot(edge, edge), 0.0, 1.0);
      nearest = std::min(nearest, glm::length(p - a - along * edge));
    }
  });
  return nearest;
}

TEST(InstructionSets, AnswerTheSameButForRaysWithinFloatStepsOfAnEdge) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 9000, 32);
  spec.terrain.shape.height_m = 500;
  spec.radius_factor = 4.0 / 3;
  spec.prisms.emplace_back();
  spec.prisms[0].per_km2 = 60;
  const auto world = std::make_shared<const World>(load_world(spec));
  RadarSettings s;
  s.frustum = FrustumKind::oblique;
  s.plates = PlateKind::nearest;
  s.r_min_m = 2000;
  s.r_max_m = 8000;
  s.pixel_columns = 1400;
  s.pixel_rows = 1400;
  s.azimuth_bins = 72;
  s.range_bins = 64;
  const Pose pose = test::pose_over_origin(*world, 1500, 40);
  Hits first;
  std::vector<double> first_power;
  const char* first_name = nullptr;
  int sets = 0;
  for (const TracerIsa isa : kNamedIsas) {
    if (!has_isa(isa)) {
      std::printf("    %s: this processor has none\n", isa_name(isa));
      continue;
    }
    ++sets;
    const auto scene = std::make_shared<const Scene>(world, test::two_materials(), 0, RayMethod::embree, isa);
    Hits hits;
    RenderOptions options;
    options.threads = 1;  // the observer is not locked
    options.observer = first_name ? &hits : &first;
    const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, options);
    if (!first_name) {
      first_name = isa_name(isa);
      first_power = frame.bins.power_w;
      EXPECT_GT(first.all().size(), 1000000u);
      continue;
    }
    std::size_t same = 0, differ = 0, missing = 0;
    double farthest_m = 0;
    for (const auto& [pixel, hit] : hits.all()) {
      const auto other = first.all().find(pixel);
      if (other == first.all().end()) {
        ++missing;
        farthest_m = std::max(farthest_m, from_edge_m(*world, hit));
        continue;
      }
      if (std::memcmp(&hit.slant_range_m, &other->second.slant_range_m, sizeof(double)) == 0 &&
          hit.face == other->second.face) {
        ++same;
        continue;
      }
      ++differ;
      // The nearer of the two is the one whose edge the ray passes, unless it goes where two surfaces cut
      // each other, as at the foot of a wall.
      const ExactHit& nearer = hit.slant_range_m < other->second.slant_range_m ? hit : other->second;
      const double apart_m = std::abs(hit.slant_range_m - other->second.slant_range_m);
      farthest_m = std::max(farthest_m, std::min(apart_m, from_edge_m(*world, nearer)));
    }
    missing += first.all().size() - same - differ;
    double power = 0, change = 0;
    for (std::size_t k = 0; k < first_power.size(); ++k) {
      power += first_power[k];
      change += std::abs(frame.bins.power_w[k] - first_power[k]);
    }
    std::printf(
        "    %s against %s: %zu rays the same to the bit, %zu differ, %zu met by one alone; farthest "
        "from an edge %.2g m; %.2g of the power elsewhere\n",
        isa_name(isa), first_name, same, differ, missing, farthest_m, change / power);
    // Coordinates up to 9 km have float steps of 1 mm, the direction's rounding moves a ray by 8 km x 2^-24 =
    // 0.5 mm, and a slope of 5 degrees stretches that elevenfold along the ground: 2 x 1.5 mm x 11.5.
    EXPECT_LE(farthest_m, 0.035) << isa_name(isa);
    EXPECT_LE(differ + missing, hits.all().size() / 100000) << isa_name(isa);
    EXPECT_LE(change, 1e-4 * power) << isa_name(isa);
  }
  if (sets < 2) GTEST_SKIP() << "one instruction set: nothing to compare";
}

}  // namespace
}  // namespace obliq
