// What a scene keeps in memory, and that Embree's part is made when rays are first cast.
#include "server/radar/echo/speckle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <set>
#include <thread>

#include "server/radar/echo/scattering.h"
#include "server/scene/embree_tracer.h"
#include "server/scene/scene_memory.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::speckle_test {
namespace {

class SpeckleTest : public testing::Test {
 protected:
  World world_ = load_world(test::synthetic_spec(SyntheticKind::hills, 5000, 50));
  glm::dvec3 antenna_{10, 1500, -20};
  double lambda_ = 0.03;
  SpeckleField field(const glm::dvec3& antenna, std::int64_t seed = 1) const {
    return SpeckleField(world_, antenna, lambda_, 32, 2e-3, seed);
  }
};

TEST_F(SpeckleTest, GroundAmplitudesAreCircularGaussianWithUnitPower) {
  const SpeckleField speckle = field(antenna_);
  std::complex<double> mean = 0;
  double power = 0, power2 = 0;
  constexpr int n = 300;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const std::complex<double> u =
          speckle.response(speckle.scatterer(3000, {i * 9.0, 0, j * 9.0}, kNoFace, 0));
      mean += u;
      power += std::norm(u);
      power2 += std::norm(u) * std::norm(u);
    }
  }
  constexpr double count = n * n;
  // Standard errors: 1/sqrt(n) = 0.0033 for mean and power; |u|^4 of an exponential has variance 20: 0.015.
  EXPECT_LT(std::abs(mean / count), 5 * 0.0033);
  EXPECT_NEAR(power / count, 1, 5 * 0.0033);
  EXPECT_NEAR(power2 / count, 2, 5 * 0.015);
}

TEST_F(SpeckleTest, CellsAreAtMostHalfABinAndPowersOfTwo) {
  const SpeckleField speckle = field(antenna_);
  for (double r = 100; r < 90000; r *= 1.1) {
    const Scatterer s = speckle.scatterer(r, {1, 0, 1}, kNoFace, 0);
    const double side = std::ldexp(1.0, s.level);
    const double octave = std::exp2(std::floor(std::log2(r)));
    EXPECT_LE(side, 0.5 * std::min(32.0, octave * 2e-3));
    EXPECT_GT(2 * side, 0.5 * std::min(32.0, octave * 2e-3));
  }
}

TEST_F(SpeckleTest, PhaseTurnsByAQuarterWhenTheAntennaMovesAnEighthOfAWavelengthTowardsTheCell) {
  const SpeckleField before = field(antenna_);
  const Scatterer s = before.scatterer(2000, {1200, 0, 900}, kNoFace, 0);
  const double side = std::ldexp(1.0, s.level);
  const double x = (s.x_cell + 0.5) * side;
  const double z = (s.z_cell + 0.5) * side;
  const glm::dvec3 cell(x, world_.grid.height_at_m(x, z), z);
  glm::dvec3 line = cell - antenna_;
  line = line / std::sqrt(line.x * line.x + line.y * line.y + line.z * line.z);
  const SpeckleField after = field(antenna_ + line * (lambda_ / 8));
  // phase = -4 pi r / lambda: r shrinks by lambda / 8, the phase grows by pi / 2. The second-order term of
  // the range, (lambda / 8)^2 / 2 r, is below 1e-8 m.
  const double turned = std::arg(after.response(s) / before.response(s));
  EXPECT_NEAR(turned, std::numbers::pi / 2, 1e-5);
}

TEST_F(SpeckleTest, DifferentSeedsPlacesLevelsAndMaterialsGiveDifferentHashes) {
  std::set<std::uint64_t> hashes;
  int n = 0;
  for (std::int64_t seed : {1, 2}) {
    const SpeckleField speckle = field(antenna_, seed);
    for (int i = -20; i < 20; ++i)
      for (int j = -20; j < 20; ++j)
        for (int level : {0, 3})
          for (int material : {0, 5}) {
            hashes.insert(speckle.hash(
                {i, j, kNoFace, static_cast<std::int16_t>(level), static_cast<std::uint8_t>(material)}));
            ++n;
          }
  }
  EXPECT_EQ(static_cast<int>(hashes.size()), n);
}

Material material(ScatteringModel model) {
  Material m;
  m.model = model;
  m.gamma = 0.1;
  m.reflectivity = 0.5;
  m.rms_slope = 0.1;
  m.plate_tau = 2;
  m.plate_exponent = 2;
  return m;
}

TEST(Scattering, ConstantGammaIsGammaTimesProjectedArea) {
  const ScatteringTable table({material(ScatteringModel::constant_gamma)}, 0.03);
  for (double cosine : {1.0, 0.5, 1e-9, 0.0}) EXPECT_DOUBLE_EQ(table.cross_section_m2(0, 30, cosine), 3.0);
}

TEST(Scattering, GeometricOpticsMatchesItsFormulaAndKeepsItsFloor) {
  const ScatteringTable table({material(ScatteringModel::geometric_optics)}, 0.03);
  for (double degrees : {0.0, 3.0, 10.0, 25.0}) {
    const double theta = degrees * std::numbers::pi / 180;
    const double t = std::tan(theta);
    // sigma0 = R2 exp(-t^2/2s^2) sec^4 / (2 s^2), and sigma = sigma0 A with A = projected area / cos.
    const double expected = 0.5 * std::exp(-t * t / 0.02) / std::pow(std::cos(theta), 5) / 0.02 + 0.1;
    EXPECT_NEAR(table.cross_section_m2(0, 1, std::cos(theta)) / expected, 1, 1e-12) << degrees;
  }
  // A roof at 75 degrees: the lobe is exp(-696), the floor is left.
  EXPECT_NEAR(table.cross_section_m2(0, 1, std::cos(75 * std::numbers::pi / 180)), 0.1, 1e-15);
  EXPECT_DOUBLE_EQ(table.cross_section_m2(0, 1, 0), 0.1);
}

TEST(Scattering, FlatPlateIsThePapersEquation12Corrected) {
  const double lambda = 0.03;
  const ScatteringTable table({material(ScatteringModel::flat_plate)}, lambda);
  // 4 pi tau (A cos theta)^2 / lambda^2 with tau = 2 cos^2 theta, projected area 3 m^2, theta 60 degrees.
  const double expected = 4 * std::numbers::pi * 2 * 0.25 * 9 / (lambda * lambda);
  EXPECT_NEAR(table.cross_section_m2(0, 3, 0.5) / expected, 1, 1e-14);
  EXPECT_EQ(table.cross_section_m2(0, 3, 0), 0);
}

TEST(Scattering, ZeroReflectivityAndZeroGammaGiveExactZeros) {
  Material black = material(ScatteringModel::geometric_optics);
  black.gamma = 0;
  black.reflectivity = 0;
  const ScatteringTable table({black}, 0.03);
  for (double cosine : {1.0, 0.3, 0.0}) EXPECT_EQ(table.cross_section_m2(0, 5, cosine), 0);
}

constexpr double kReach_m = 16000;
constexpr double kCell_m = 20;

WorldSpec hills(double per_km2) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, kReach_m, kCell_m);
  spec.terrain.shape.height_m = 600;
  if (per_km2 > 0) {
    spec.prisms.emplace_back();
    spec.prisms[0].per_km2 = per_km2;
  }
  return spec;
}

RadarSettings settings_of(FrustumKind kind) {
  return test::radar_settings(kind, {2000, 8000}, {64, 64}, {128, 128});
}

Frame frame_of(const std::shared_ptr<const Scene>& scene, FrustumKind kind, int threads) {
  const RadarSettings settings = settings_of(kind);
  RenderOptions options;
  options.threads = threads;
  return render(scene, test::snapshot(settings), test::pose_over_origin(scene->world(), 2000),
                {0, settings.azimuth_bins}, options);
}

TEST(SceneMemory, APostTakesEightBytesForTheSweepAndThirtyTwoForRays) {
  const auto scene = test::make_scene(load_world(hills(0)));
  const auto posts = static_cast<double>(scene->world().grid.y_m.size());
  ASSERT_GT(posts, 2e6);
  EXPECT_LE(static_cast<double>(scene_memory(*scene).total()) / posts, 8);
  scene->tracer();
  EXPECT_LE(static_cast<double>(scene_memory(*scene).total()) / posts, 32);
  EXPECT_GE(scene_memory(*scene).tracer_peak, scene_memory(*scene).tracer);
}

TEST(SceneMemory, AWallsTriangleTakesOneHundredAndFiftyBytes) {
  const auto bare = test::make_scene(load_world(hills(0)));
  const auto built = test::make_scene(load_world(hills(80)));
  const auto walls = 2.0 * static_cast<double>(built->world().buildings.ring_xz_m.size());
  ASSERT_GT(walls, 4e5);
  const auto beyond_bare = [&] {
    return static_cast<double>(scene_memory(*built).total() - scene_memory(*bare).total()) / walls;
  };
  std::printf("    %.1f bytes a wall triangle for the sweep\n", beyond_bare());
  bare->tracer();
  built->tracer();
  std::printf("    %.1f bytes a wall triangle for rays\n", beyond_bare());
  EXPECT_LE(beyond_bare(), 150);
}

TEST(SceneMemory, PlanningAndTheSweepLeaveEmbreeOut) {
  const auto scene = test::make_scene(load_world(hills(5)));
  const auto settings = test::snapshot(settings_of(FrustumKind::oblique));
  EXPECT_TRUE(plan_frame(scene, settings, test::pose_over_origin(scene->world(), 2000)).plan);
  frame_of(scene, FrustumKind::sweep, 2);
  EXPECT_EQ(scene->built_tracer(), nullptr);
  EXPECT_EQ(scene_memory(*scene).tracer, 0u);
  EXPECT_EQ(memory_line(*scene).find("Embree"), std::string::npos) << memory_line(*scene);
  frame_of(scene, FrustumKind::oblique, 2);
  EXPECT_NE(scene->built_tracer(), nullptr);
  EXPECT_NE(memory_line(*scene).find("Embree"), std::string::npos) << memory_line(*scene);
}

TEST(SceneMemory, FramesHaveTheSameBitsWhoeverBuildsTheTracer) {
  const auto world = std::make_shared<const World>(load_world(hills(5)));
  const auto early = std::make_shared<const Scene>(world, test::two_materials(), 0);
  early->tracer();
  const Frame expected = frame_of(early, FrustumKind::oblique, 1);
  const auto late = std::make_shared<const Scene>(world, test::two_materials(), 0);
  test::expect_same_bits(frame_of(late, FrustumKind::oblique, 4).bins, expected.bins);
  const auto swept = std::make_shared<const Scene>(world, test::two_materials(), 0);
  const Frame before = frame_of(swept, FrustumKind::sweep, 2);
  test::expect_same_bits(frame_of(swept, FrustumKind::oblique, 2).bins, expected.bins);
  test::expect_same_bits(frame_of(swept, FrustumKind::sweep, 2).bins, before.bins);
}

TEST(SceneMemory, SeveralRadarsAtOnceBuildOneTracer) {
  const auto scene = test::make_scene(load_world(hills(0)));
  std::vector<const EmbreeTracer*> tracers(4);
  {
    std::vector<std::jthread> radars;
    for (const EmbreeTracer*& tracer : tracers) radars.emplace_back([&] { tracer = &scene->tracer(); });
  }
  for (const EmbreeTracer* tracer : tracers) EXPECT_EQ(tracer, scene->built_tracer());
}

}  // namespace
}  // namespace obliq::speckle_test
