// The same bits for any number of threads in sectors and bin counts at the edges of what is allowed.
// Hard case 9: the same rays through Embree's SSE4.2, AVX, AVX2 and AVX-512 kernels. What a ray meets is the
// same to the bit, but for rays that pass a triangle's edge within float steps: there two kernels may round
// to different sides. Ranges come from the triangle's plane in double, so that either answer is exact for the
// surface that it names.
#include "tests/support/same_bits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <glm/geometric.hpp>
#include <string>
#include <unordered_map>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/scene/embree_tracer.h"
#include "server/scene/exact_hit.h"
#include "terrain/buildings/building_mesh.h"
#include "tests/support/scenes.h"

namespace obliq::same_bits_test {
namespace {

/// Hills with a void, seen from above their tops; small enough for many frames.
class SameBits : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 12000, 50);
    spec.terrain.shape.height_m = 600;
    spec.radius_factor = 4.0 / 3;
    World world = load_world(spec);
    for (int j = 320; j < 340; ++j)
      for (int i = 250; i < 270; ++i) world.grid.y_m[world.grid.index(i, j)] = NAN;
    scene_ = test::make_scene(std::move(world));
  }
  static void TearDownTestSuite() { scene_.reset(); }

  static RadarSettings settings(FrustumKind kind, double sector_deg = 120) {
    return test::radar_settings(kind, {2000, 10000, sector_deg}, {100, 90}, {300, 300});
  }
  static Frame frame(const RadarSettings& s, int threads = 2, double bearing_deg = 40) {
    RenderOptions options;
    options.threads = threads;
    return render(scene_, test::snapshot(s), test::pose_over_origin(scene_->world(), 1500, bearing_deg),
                  {0, s.azimuth_bins}, options);
  }

  static std::shared_ptr<const Scene> scene_;
};
std::shared_ptr<const Scene> SameBits::scene_;

TEST_F(SameBits, ComeFromTheWholeCircleForTheSameBearings) {
  // 360 degrees in 1-degree bins, centre 40: bins 120..239 look at -20..100 degrees. The pixels of a sector
  // of 120 degrees lie elsewhere, so only the states can be compared, and rounding of the bin's bearing may
  // move a bin's edge across a mountain top.
  RadarSettings full = settings(FrustumKind::oblique, 360);
  full.pixel_columns = 720;
  full.azimuth_bins = 360;
  const Frame circle = frame(full);
  EXPECT_EQ(circle.stats.hits + circle.stats.rejected <= circle.stats.rays, true);
  RadarSettings part = settings(FrustumKind::oblique, 120);
  part.pixel_columns = 240;
  part.azimuth_bins = 120;
  const Frame sector = frame(part);
  int differ = 0;
  const auto hidden = [](std::uint8_t state) { return state >= 2; };
  for (std::size_t a = 0; a < 120; ++a)
    for (std::size_t r = 0; r < 90; ++r)
      differ +=
          hidden(circle.bins.state[(a + 120) * 90 + r]) != hidden(sector.bins.state[a * 90 + r]) ? 1 : 0;
  std::printf("    %d of 10800 bins differ\n", differ);
  EXPECT_LT(differ, 108);
}

TEST_F(SameBits, CoverEverySectorAndBinCountThatIsAllowed) {
  struct Case {
    double sector_deg, bearing_deg;
    int azimuth_bins;
  };
  for (const FrustumKind kind : {FrustumKind::sweep, FrustumKind::oblique, FrustumKind::symmetric}) {
    for (const Case& k :
         {Case{360, 0, 360}, Case{360, 90, 1}, Case{60, 0, 64}, Case{60, 350, 7}, Case{200, 10, 33},
          Case{120, 180, 1}, Case{0.001, 45, 1}, Case{180, 270, 8}, Case{359.999, -180, 1000}}) {
      if (kind == FrustumKind::symmetric && k.sector_deg >= 180) continue;
      RadarSettings s = settings(kind, k.sector_deg);
      s.azimuth_bins = k.azimuth_bins;
      SCOPED_TRACE("frustum " + std::to_string(static_cast<int>(kind)) + " sector " +
                   std::to_string(k.sector_deg) + " bearing " + std::to_string(k.bearing_deg));
      const Frame one = frame(s, 1, k.bearing_deg);
      test::expect_same_bits(one.bins, frame(s, 8, k.bearing_deg).bins);
      EXPECT_GT(one.stats.samples, 1000u);
      std::uint64_t counted = 0;
      for (const std::uint32_t n : one.bins.count) counted += n;
      EXPECT_EQ(counted, one.stats.samples);
      // A sweep has at least one plane a bin, and cuts ground and buildings elsewhere with other bins.
      if (kind == FrustumKind::sweep) continue;
      // No ray is lost between bins and none is counted twice: with rows and columns fixed, the number of
      // samples does not depend on how many bins the sector is divided into.
      RadarSettings single = s;
      single.azimuth_bins = 1;
      const Frame undivided = frame(single, 1, k.bearing_deg);
      EXPECT_EQ(one.stats.rays, undivided.stats.rays);
      EXPECT_EQ(one.stats.samples, undivided.stats.samples);
    }
  }
}

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
  const Building& b = all.list[all.building_of_face[hit.face]];
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
  RadarSettings s = test::radar_settings(FrustumKind::oblique, {2000, 8000}, {72, 64}, {1400, 1400});
  s.plates = PlateKind::nearest;
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
}  // namespace obliq::same_bits_test
