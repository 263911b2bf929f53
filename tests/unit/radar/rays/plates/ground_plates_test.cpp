// Plates of eight pixels at a time over bare ground, beside the walks of one pixel at a time.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>

#include "server/radar/frame_plan.h"
#include "server/radar/profile/local_sight.h"
#include "server/radar/rays/plates/plate.h"
#include "server/radar/simd/kernels.h"
#include "server/scene/tolerances.h"
#include "tests/support/made_worlds.h"
#include "tests/support/random_scenes.h"

namespace obliq::ground_plates_test {
namespace {

constexpr int kLanes = GroundPlates::kLanes;
using Eight = std::array<double, kLanes>;

/// Waves of several lengths, up to 60 m high: slopes up to 40 degrees, with crests and hollows.
World waves(test::Dice& dice) {
  std::array<double, 12> a{};
  for (double& number : a) number = dice.uniform(-1, 1);
  return test::made_world(1500, 20, [=](double x, double z) {
    return 30 * std::sin((a[0] * x + a[1] * z) / 50 + a[2]) +
           20 * std::sin((a[3] * x + a[4] * z) / 30 + a[5]) +
           60 * std::sin((a[6] * x + a[7] * z) / 200 + a[8]);
  });
}

/// Bare ground under a camera that looks straight down.
PlateField field_over(const World& world, const glm::dvec3& antenna_m, const RangeAxis& axis) {
  return {ground_view(world.grid, antenna_m),
          nullptr,
          nullptr,
          axis,
          64 * world.grid.cell_m,
          kLook_cells,
          kTouching_m,
          false,
          0.05,
          0.05,
          1,
          0,
          0,
          1};
}

/// What is visible in a vertical plane, marched from near the nadir.
std::vector<SurfaceSegment> all_visible(LocalSurface& surface) {
  std::vector<SurfaceSegment> visible;
  surface.walk_out({1, 0, -HUGE_VAL}, HUGE_VAL, HUGE_VAL, visible);
  return visible;
}

/// Eight rays over a world, each in a plane of its own, that hit visible ground.
struct Scene8 {
  World world;
  glm::dvec3 antenna_m;
  PlateField field;
  Eight dir_x{}, dir_y{}, dir_z{}, range_m{};
  const std::vector<RoofSpan> no_roofs;

  explicit Scene8(std::uint64_t seed) {
    test::Dice dice(seed);
    world = waves(dice);
    antenna_m = {dice.uniform(-200, 200), dice.uniform(150, 900), dice.uniform(-200, 200)};
    field = field_over(world, antenna_m, {200, 400, 1400, 5});
    field.half_width = dice.uniform(0.001, 0.02);
    field.half_height = dice.uniform(0.001, 0.02);
    LocalSurface surface(world, antenna_m);
    const double bearing = dice.uniform(0, 6.28);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double b = bearing + 0.001 * static_cast<double>(lane);
      surface.aim(std::sin(b), std::cos(b), no_roofs);
      const std::vector<SurfaceSegment> visible = all_visible(surface);
      const SurfaceSegment& at =
          visible[visible.size() / 8 + dice.bits() % (visible.size() - visible.size() / 4)];
      const double t = dice.uniform(0.1, 0.9);
      const double d = at.near_d_m + t * (at.far_d_m - at.near_d_m);
      const double h = at.near_h_m + t * (at.far_h_m - at.near_h_m);
      range_m[lane] = std::hypot(d, h);
      dir_x[lane] = std::sin(b) * d / range_m[lane];
      dir_y[lane] = h / range_m[lane];
      dir_z[lane] = std::cos(b) * d / range_m[lane];
    }
  }
  PlateRays rays() const { return {dir_x.data(), dir_y.data(), dir_z.data(), range_m.data()}; }
};

using Shares = std::map<int, double>;

Shares share_of_bins(const Scene8& scene, const GroundPlates& plates, std::size_t lane) {
  LocalSurface surface(scene.world, scene.antenna_m);
  surface.aim(plates.sin_bearing[lane], plates.cos_bearing[lane], scene.no_roofs);
  const SightPoint at{plates.d_m[lane], plates.h_m[lane], plates.slope[lane]};
  std::vector<SurfaceSegment> visible;
  const double half = plates.half_extent[lane], reach = scene.field.reach_m;
  surface.walk_out(at, at.slope + half, at.d_m + reach, visible);
  surface.walk_in(at, at.slope - half, at.d_m - reach, visible);
  BinGrid bins;
  static_cast<RangeAxis&>(bins) = scene.field.axis;
  Plate plate;
  for (const SurfaceSegment& segment : visible) plate.add(bins, segment);
  Shares shares;
  for (const PlatePart& part : plate.finish(1)) shares[part.range_bin] += part.share;
  return shares;
}

Shares share_of_bins(const GroundPlates& plates, std::size_t lane) {
  Shares shares;
  double sum = 0;
  for (std::size_t row = 0; row < static_cast<std::size_t>(plates.n); ++row) {
    if ((plates.whose[row] >> lane & 1) == 0) continue;
    const double share = plates.far_sine[row][lane] - plates.near_sine[row][lane];
    shares[static_cast<int>(plates.bin[row][lane])] += share;
    sum += share;
  }
  for (auto& [bin, share] : shares) share /= sum;
  return shares;
}

double difference(const Shares& a, Shares b) {
  double most = 0;
  for (const auto& [bin, share] : a) {
    most = std::max(most, std::abs(share - b[bin]));
    b.erase(bin);
  }
  for (const auto& [bin, share] : b) most = std::max(most, share);
  return most;
}

TEST(PlateLanes, CoverWhatTheWalksOfOnePixelCover) {
  // Shares of a pixel's light, sums of a few differences of sines: 1e-7 of a plate is 1e-10 of a radian. A
  // walk inwards is content with the first rise above the pixel's lower edge; lanes that started farther in
  // may see another one in front of it: 1 in 100. A version that forgets what lies behind a crest, or cuts at
  // the wrong edge, differs in one of 4.
  int walked = 0, differ = 0, several = 0, shadowed = 0;
  constexpr int kScenes = 400;
  for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
    const Scene8 scene(seed);
    GroundPlates plates;
    active_kernels().ground_plates(scene.field, scene.rays(), 0, 0xff, plates);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if ((plates.walked >> lane & 1) == 0) continue;
      ++walked;
      const Shares expected = share_of_bins(scene, plates, lane);
      several += expected.size() > 1 ? 1 : 0;
      if (!expected.empty())
        shadowed +=
            expected.rbegin()->first - expected.begin()->first >= static_cast<int>(expected.size()) ? 1 : 0;
      differ += difference(expected, share_of_bins(plates, lane)) > 1e-7 ? 1 : 0;
    }
  }
  std::printf("of %d plates %d walked, %d differ, %d in several bins, %d with a shadow in them\n",
              kScenes * kLanes, walked, differ, several, shadowed);
  EXPECT_GT(walked, 0.9 * kScenes * kLanes);
  EXPECT_GT(several, walked / 2);
  EXPECT_GT(shadowed, walked / 100);
  EXPECT_LE(differ, walked / 100);
}

TEST(PlateLanes, AreTheSameInEveryInstructionSet) {
  std::vector<std::uint8_t> material;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Scene8 scene(seed);
    scene.field.incidence = seed % 2 == 0;
    if (seed % 4 < 2) {
      material.resize(static_cast<std::size_t>(scene.world.grid.nx - 1) *
                      static_cast<std::size_t>(scene.world.grid.nz - 1));
      for (std::size_t k = 0; k < material.size(); ++k)
        material[k] = static_cast<std::uint8_t>(hash_cell(seed, static_cast<int>(k / 3), 0) % 3);
      scene.field.material = material.data();
    }
    const Eight solid{1, 2, 3, 4, 5, 6, 7, 8}, cosine{0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5};
    const std::int32_t azimuth[kLanes] = {0, 0, 1, 1, 2, 2, 3, 3};
    std::vector<std::uint8_t> visible(static_cast<std::size_t>(scene.field.axis.n_range));
    for (std::size_t k = 0; k < visible.size(); ++k) visible[k] = k % 5 != 0 ? 1 : 0;
    std::vector<std::unique_ptr<SampleBatch>> found;
    std::vector<unsigned> walked;
    for (const Kernels& kernels : all_kernels()) {
      GroundPlates plates;
      kernels.ground_plates(scene.field, scene.rays(), 0, 0xfb, plates);
      EXPECT_EQ(plates.walked & 4, 0u);
      PlatePixels pixels{solid.data(), cosine.data(), scene.range_m.data(), azimuth, {}, {}};
      for (auto& marks : pixels.visible) marks = visible.data();
      found.push_back(std::make_unique<SampleBatch>());
      found.back()->n = 0;
      const unsigned dark = kernels.plate_samples(scene.field, pixels, plates, *found.back());
      walked.push_back(plates.walked << 8 | dark);
      // What a pixel has is shared out whole.
      double sum = 0, expected = 0;
      for (int s = 0; s < found.back()->n; ++s) sum += found.back()->solid_angle_sr[s];
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        if (((plates.walked & ~dark) >> lane & 1) != 0) expected += solid[lane];
      EXPECT_NEAR(sum, expected, 1e-12 * expected);
    }
    for (std::size_t set = 1; set < found.size(); ++set) {
      const SampleBatch& a = *found[0];
      const SampleBatch& b = *found[set];
      EXPECT_EQ(walked[set], walked[0]);
      ASSERT_EQ(b.n, a.n);
      const auto same = [&](const auto* p, const auto* q) {
        return std::memcmp(p, q, static_cast<std::size_t>(a.n) * sizeof *p) == 0;
      };
      EXPECT_TRUE(same(a.azimuth_bin, b.azimuth_bin) && same(a.slant_range_m, b.slant_range_m) &&
                  same(a.solid_angle_sr, b.solid_angle_sr) && same(a.cos_incidence, b.cos_incidence) &&
                  same(a.sin_elevation, b.sin_elevation) && same(a.x_m, b.x_m) && same(a.z_m, b.z_m) &&
                  same(a.material, b.material) && same(a.face, b.face))
          << seed << ' ' << all_kernels()[set].name;
    }
  }
}

TEST(PlateLanes, MaterialsAndIncidenceAreThoseOfTheGround) {
  // A plane that rises to the south at 0.2, with a strip of another material: every sample has its own, and
  // the incidence of the plane seen from there. 1e-3: the cosine at a part's middle for its mean.
  World world = test::made_world(1500, 20, [](double, double z) { return 0.2 * z; });
  const glm::dvec3 antenna(0, 500, 0);
  const std::size_t cells = static_cast<std::size_t>(world.grid.nx - 1);
  std::vector<std::uint8_t> material(cells * cells);
  for (std::size_t k = 0; k < material.size(); ++k) material[k] = k / cells % 2 == 0 ? 1 : 2;
  PlateField field = field_over(world, antenna, {100, 300, 1800, 15});
  field.material = material.data();
  field.incidence = true;
  Eight dir_x{}, dir_y{}, dir_z{}, range{}, solid{}, cosine{};
  PlatePixels pixels{solid.data(), cosine.data(), range.data(), nullptr, {}, {}};
  const std::int32_t azimuth[kLanes] = {};
  pixels.azimuth_bin = azimuth;
  const std::vector<std::uint8_t> visible(100, 1);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const double b = 0.3 * static_cast<double>(lane), d = 500;
    const glm::dvec3 at(d * std::sin(b), 0.2 * d * std::cos(b) - 500, d * std::cos(b));
    range[lane] = glm::length(at);
    dir_x[lane] = at.x / range[lane];
    dir_y[lane] = at.y / range[lane];
    dir_z[lane] = at.z / range[lane];
    solid[lane] = 1;
    pixels.visible[lane] = visible.data();
  }
  GroundPlates plates;
  active_kernels().ground_plates(field, {dir_x.data(), dir_y.data(), dir_z.data(), range.data()}, 0, 0xff,
                                 plates);
  EXPECT_EQ(plates.walked, 0xffu);
  const auto samples = std::make_unique<SampleBatch>();
  samples->n = 0;
  active_kernels().plate_samples(field, pixels, plates, *samples);
  EXPECT_GT(samples->n, 3 * kLanes);
  int both[2] = {};
  for (int s = 0; s < samples->n; ++s) {
    const glm::dvec3 from(samples->x_m[s], 0.2 * samples->z_m[s] - 500, samples->z_m[s]);
    const double expected = std::abs(-0.2 * from.z + from.y) / std::sqrt(1.04) / glm::length(from);
    EXPECT_NEAR(samples->cos_incidence[s], expected, 1e-3);
    const auto row = static_cast<std::size_t>(std::floor((samples->z_m[s] - world.grid.z0_m) / 20));
    EXPECT_EQ(samples->material[s], row % 2 == 0 ? 1 : 2);
    ++both[row % 2];
  }
  EXPECT_GT(both[0], 0);
  EXPECT_GT(both[1], 0);
}

TEST(PlateLanes, ExtentsAreThoseOfHalfARowAndHalfAColumn) {
  // Central differences of a pixel's slope by its row and its column, whole steps for derivatives: 1e-3.
  for (const bool pitched : {false, true}) {
    const SectorBox box(900, 200, 1200, 6000, 1.0);
    const PerspectiveFrustum camera =
        pitched ? symmetric_frustum(box, 1.0, 512, 512) : oblique_frustum(box, 512, 512);
    const World world = test::made_world(8000, 100, [](double, double) { return 0; });
    const double pitch = pitched ? camera.pitch_rad : std::numbers::pi / 2;
    PlateField field = field_over(world, {0, 900, 0}, {100, 1200, 6000, 48});
    field.half_width = camera.pixel_width_m() / camera.near_m / 2;
    field.half_height = camera.pixel_height_m() / camera.near_m / 2;
    field.sin_pitch = std::sin(pitch);
    field.cos_pitch = std::cos(pitch);
    field.sin_bearing = std::sin(0.7);
    field.cos_bearing = std::cos(0.7);
    Eight dir_x{}, dir_y{}, dir_z{}, range{}, expected{};
    const auto slope = [&](double column, double row) {
      const glm::dvec3 d = camera.direction(column, row);
      return d.y / std::hypot(d.x, d.z);
    };
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double column = 60 * static_cast<double>(lane) + 10, row = 60 * static_cast<double>(lane) + 20;
      const glm::dvec3 d = glm::normalize(camera.direction(column, row));
      dir_x[lane] = d.x * std::cos(0.7) + d.z * std::sin(0.7);
      dir_y[lane] = d.y;
      dir_z[lane] = d.z * std::cos(0.7) - d.x * std::sin(0.7);
      range[lane] = 1000;
      expected[lane] = std::hypot(slope(column, row + 0.5) - slope(column, row - 0.5),
                                  slope(column + 0.5, row) - slope(column - 0.5, row)) /
                       2;
    }
    GroundPlates plates;
    active_kernels().ground_plates(field, {dir_x.data(), dir_y.data(), dir_z.data(), range.data()}, 0, 0,
                                   plates);
    EXPECT_EQ(plates.walked, 0u);
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      EXPECT_NEAR(plates.half_extent[lane], expected[lane], 1e-3 * expected[lane]) << pitched << ' ' << lane;
  }
}

}  // namespace
}  // namespace obliq::ground_plates_test
