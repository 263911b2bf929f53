// Speckle of one bin decorrelates with look angle as theory says.
//
// A resolution cell filled with independent scatterers of equal power p at places x keeps, between two looks,
// the coherence |sum of p exp(-j (k1 - k2) x)| / sum of p, k = (4 pi / lambda) times the horizontal part of
// the unit line of sight (Zebker & Villasenor, "Decorrelation in interferometric radar echoes", IEEE TGRS 30,
// 1992, "spatial baseline decorrelation", there for a sinc-shaped response; here the bin's response is 1
// inside, 0 outside). For 8 ground cells of side a in a row that is the Dirichlet kernel
//   |sin(4 q a) / (8 sin(q a / 2))|, q = |k1 - k2|,
// whose first zero, 8 q a = 2 pi, is their critical baseline: lambda / 2 over the bin's length seen along the
// change. Both looks see the same 8 x 8 cells, so only the axis along which the line of sight moves counts.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>
#include <numbers>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "tests/support/scatterer_shares.h"
#include "tests/support/scenes.h"
#include "tests/support/sources.h"

namespace obliq {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;
constexpr double kFrequency_ghz = 10;
constexpr double kWavelength_m = 299792458.0 / (kFrequency_ghz * 1e9);
constexpr int kSeeds = 2000;

/// Coherence of 8 cells of 1 m in a row.
double dirichlet8(double q_per_m) {
  const double half = q_per_m / 2;
  return half == 0 ? 1 : std::abs(std::sin(8 * half) / (8 * std::sin(half)));
}

class DecorrelationOfEverySource : public testing::TestWithParam<test::NamedSource> {
 protected:
  /// Flat ground where the bin lies, with nodes every quarter metre: a sample of the sweep is as long as the
  /// bin's part of a triangle, and only samples finer than the cells tell them apart.
  static std::shared_ptr<const Scene> ground_near(double middle_m) {
    World world;
    world.frame = WorldFrame(33 * kPi / 180, -99.5 * kPi / 180, std::numeric_limits<double>::infinity());
    world.grid.cell_m = 0.25;
    world.grid.nx = world.grid.nz = 97;
    world.grid.x0_m = -12;
    world.grid.z0_m = middle_m - 12;
    world.grid.y_m.assign(97 * 97, 0.0f);
    return test::make_scene(std::move(world), test::constant_gamma_materials());
  }

  /// One look of an antenna at (x, height, z) on one bin: ground from near_m to far_m away from it.
  struct Look {
    glm::dvec3 antenna_m{0.0};
    RadarSettings settings;
    test::BinShares shares;
    double power_w = 0;
    std::vector<Complex> voltage;  ///< [seed]

    Look(const std::shared_ptr<const Scene>& scene, const glm::dvec3& antenna, double bearing, double near_m,
         double far_m)
        : antenna_m(antenna) {
      settings.frustum = GetParam().kind;
      settings.sub_columns = 0;              // shares are of samples
      settings.plates = PlateKind::nearest;  // three pixels a cell and side are fine enough
      settings.frequency_ghz = kFrequency_ghz;
      // Between 4096 and 8192 m a cell is the largest power of two up to 4096 m x width / 2: 1 m. At 8186 m
      // the bin is then 7.994 m wide.
      settings.sector_deg = 3.9999 / 4096 * 180 / kPi;
      settings.azimuth_bins = settings.range_bins = 1;
      settings.r_min_m = std::hypot(near_m, antenna.y);
      settings.r_max_m = std::hypot(far_m, antenna.y);
      settings.pixel_columns = settings.pixel_rows = 24;
      Pose pose;
      pose.antenna.m = antenna;
      pose.bearing_world_rad = bearing;
      pose.ground_y_m = std::numeric_limits<double>::quiet_NaN();
      shares = test::shares_of_bins(*test::plan_or_throw(scene, settings, pose)).front();
      RenderOptions options;
      options.threads = 1;
      options.states = false;
      for (int seed = 1; seed <= kSeeds; ++seed) {
        settings.speckle_seed = seed;
        const BinBlock bins = render(scene, test::snapshot(settings), pose, {0, 1}, options).bins;
        voltage.emplace_back(bins.iq[0]);
        power_w = bins.power_w[0];
      }
    }
  };

  /// Correlation of two looks over the seeds, per root of their powers: E|error|^2 = 1 / kSeeds.
  static Complex measured(const Look& one, const Look& two) {
    Complex sum = 0;
    for (std::size_t k = 0; k < kSeeds; ++k) sum += one.voltage[k] * std::conj(two.voltage[k]);
    return sum / (kSeeds * std::sqrt(one.power_w * two.power_w));
  }

  /// The same from the powers and places of the cells.
  static Complex expected(const World& world, const Look& one, const Look& two) {
    Complex sum = 0;
    for (const auto& [cell, p] : one.shares) {
      const auto other = two.shares.find(cell);
      if (other == two.shares.end()) continue;
      const glm::dvec3 place = test::reference_point_m(world, cell);
      const long double turn = test::round_trip_phase_rad(two.antenna_m, place, kFrequency_ghz) -
                               test::round_trip_phase_rad(one.antenna_m, place, kFrequency_ghz);
      sum += std::sqrt(p * other->second) *
             Complex(static_cast<double>(std::cos(turn)), static_cast<double>(std::sin(turn)));
    }
    return sum / std::sqrt(one.power_w * two.power_w);
  }

  static void compare(const World& world, const Look& one, const Look& two, double q_per_m,
                      const char* what) {
    const Complex found = measured(one, two), sum = expected(world, one, two);
    const double theory = dirichlet8(q_per_m);
    std::printf("    %s, 8 q a = %.2f x 2 pi: theory %.3f, cells %.3f, measured %.3f\n", what,
                8 * q_per_m / (2 * kPi), theory, std::abs(sum), std::abs(found));
    // |error|^2 is exponential with mean 1 / kSeeds: beyond this with a chance of 1e-6.
    const double tolerance = std::sqrt(std::log(1e6) / kSeeds);
    EXPECT_LT(std::abs(found - sum), tolerance);
    // Powers of cells in the two looks differ by pixels that fall across cell edges, 24 to 8 cells.
    EXPECT_NEAR(std::abs(sum), theory, 0.03);
    EXPECT_NEAR(std::abs(found), theory, tolerance + 0.03);
  }
};

constexpr double kParts[] = {0.3, 0.6, 1.0, 1.43};  ///< of the change to the first zero

TEST_P(DecorrelationOfEverySource, AroundTheBinFollowsTheDirichletKernel) {
  const double middle_m = 8186;
  const auto scene = ground_near(middle_m);
  const Look here(scene, {0, 100, 0}, 0, middle_m - 4, middle_m + 4);
  const double cos_elevation = middle_m / std::hypot(middle_m, 100.0);
  std::size_t whole = 0;
  for (const auto& [cell, p] : here.shares) {
    EXPECT_EQ(cell.side_m, 1);
    whole += p > here.power_w / 100 ? 1 : 0;
  }
  EXPECT_EQ(whole, 64u);
  for (const double part : kParts) {
    // (4 pi / lambda) cos(elevation) sin(angle) 8 m = 2 pi part
    const double angle = std::asin(part * kWavelength_m / (16 * cos_elevation));
    const Look there(scene, {-middle_m * std::sin(angle), 100, middle_m - middle_m * std::cos(angle)}, angle,
                     middle_m - 4, middle_m + 4);
    compare(scene->world(), here, there, part * 2 * kPi / 8, "around");
  }
}

TEST_P(DecorrelationOfEverySource, InElevationFollowsTheDirichletKernel) {
  const double middle_m = 7900, height_m = 1500;
  const auto scene = ground_near(middle_m);
  const Look here(scene, {0, height_m, 0}, 0, middle_m - 4, middle_m + 4);
  const double cos_elevation = middle_m / std::hypot(middle_m, height_m);
  for (const double part : kParts) {
    // (4 pi / lambda) (cos(elevation 1) - cos(elevation 2)) 8 m = 2 pi part
    const double cos_there = cos_elevation - part * kWavelength_m / 16;
    const double there_m = middle_m * std::sqrt(1 / (cos_there * cos_there) - 1);
    const Look there(scene, {0, there_m, 0}, 0, middle_m - 4, middle_m + 4);
    compare(scene->world(), here, there, part * 2 * kPi / 8, "higher");
  }
}

INSTANTIATE_TEST_SUITE_P(Sources, DecorrelationOfEverySource, testing::ValuesIn(test::kEverySource),
                         test::source_name<testing::TestParamInfo<test::NamedSource>>);

}  // namespace
}  // namespace obliq
