// Ground speckle of whole frames belongs to the ground: from any pose a cell answers with the same amplitude,
// and from pose to pose the phase of faces and cells follows the geometry. Geometry is worked out here in
// long double from the poses.
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

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "terrain/buildings/footprints.h"
#include "tests/support/scatterer_shares.h"
#include "tests/support/scenes.h"
#include "tests/support/sources.h"

namespace obliq::speckle_coherence_test {
namespace {

using Complex = std::complex<double>;

Pose pose_at(const World& world, const glm::dvec3& antenna_m, double bearing_rad) {
  Pose pose;
  pose.antenna.m = antenna_m;
  pose.bearing_world_rad = bearing_rad;
  pose.ground_y_m = world.grid.height_at_m(antenna_m.x, antenna_m.z);
  return pose;
}

/// A frame and what each scatterer gave to its bins.
struct Look {
  BinBlock bins;
  std::vector<test::BinShares> shares;
  glm::dvec3 antenna_m{0.0};

  Look(const std::shared_ptr<const Scene>& scene, const RadarSettings& settings, const Pose& pose)
      : antenna_m(pose.antenna.m) {
    const auto plan = test::plan_or_throw(scene, settings, pose);
    shares = test::shares_of_bins(*plan);
    // Scatterers of no reflectivity give nothing and are not there.
    for (test::BinShares& bin : shares)
      std::erase_if(bin, [](const auto& share) { return share.second == 0; });
    RenderOptions options;
    options.states = false;
    bins = render(scene, test::snapshot(settings), pose, {0, settings.azimuth_bins}, options).bins;
  }
  Complex voltage(std::size_t bin) const { return Complex(bins.iq[bin]); }
};

class CoherenceOfEverySource : public testing::TestWithParam<test::NamedSource> {
 protected:
  static std::shared_ptr<const Scene> hills() {
    static const auto scene = [] {
      WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 16000, 50);
      spec.terrain.shape.height_m = 300;
      return test::make_scene(load_world(spec), test::constant_gamma_materials());
    }();
    return scene;
  }

  /// Posts, none of whose faces is larger than a cell, on ground that reflects nothing: a bin holds faces
  /// alone.
  static std::shared_ptr<const Scene> posts() {
    static const auto scene = [] {
      World world = load_world(test::synthetic_spec(SyntheticKind::flat, 16000, 100));
      OutlineShaper shaper;
      for (int n = 0; n < 1000; ++n) {
        const double x = 57.0 * (n % 50) - 1400, z = 4500 + 190.0 * (n / 50) + 3.7 * (n % 50);
        const Polygon outline{{{{x, z}, {x + 3.5, z + 0.2}, {x + 3.2, z + 3.4}, {x - 0.1, z + 3.1}}}};
        stand_outline(world, shaper, outline, {3.5, 1, static_cast<std::uint64_t>(n)});
      }
      std::vector<Material> materials = test::constant_gamma_materials();
      materials[0].gamma = 0;
      return test::make_scene(std::move(world), materials);
    }();
    return scene;
  }

  static RadarSettings settings(double frequency_ghz = 10) {
    RadarSettings s;
    s.frustum = GetParam().kind;
    s.frequency_ghz = frequency_ghz;
    s.sub_columns = 0;  // shares are of samples
    return s;
  }
};

TEST_P(CoherenceOfEverySource, TheSameGroundGivesTheSameSpeckleFromAnyPose) {
  // Two antennas look at one valley from the south and from the east. Between 4096 and 8192 m cells are 8 m
  // for both. Bins of one cell of the first frame tell the cell's amplitude, which must explain the second's
  // bins.
  const auto scene = hills();
  RadarSettings s = settings();
  // One sample a pixel, so that many bins hold one cell.
  s.plates = PlateKind::nearest;
  s.azimuth_bins = 128;
  s.range_bins = 256;
  s.sector_deg = 55;
  s.r_min_m = 4200;
  s.r_max_m = 8100;
  s.pixel_columns = 128;
  s.pixel_rows = 320;
  const double west = -std::numbers::pi / 2;
  const Look south(scene, s, pose_at(scene->world(), {0, 1800, 0}, 0.05));
  const Look east(scene, s, pose_at(scene->world(), {6100.25, 2400.5, 6000}, west));
  std::map<test::Cell, Complex> amplitude;
  const auto phase = [&](const Look& look, const test::Cell& cell) {
    return test::round_trip_phase_rad(look.antenna_m, test::reference_point_m(scene->world(), cell),
                                      s.frequency_ghz);
  };
  for (std::size_t b = 0; b < south.shares.size(); ++b) {
    if (south.shares[b].size() != 1) continue;
    const auto& [cell, power] = *south.shares[b].begin();
    amplitude[cell] = south.voltage(b) / std::sqrt(power) * test::turned(phase(south, cell));
  }
  int explained = 0, of_several_cells = 0;
  double worst = 0;
  for (std::size_t b = 0; b < east.shares.size(); ++b) {
    const test::BinShares& bin = east.shares[b];
    if (bin.empty() ||
        !std::ranges::all_of(bin, [&](const auto& share) { return amplitude.contains(share.first); }))
      continue;
    Complex expected = 0;
    double power = 0;
    for (const auto& [cell, p] : bin) {
      expected += std::sqrt(p) * amplitude[cell] * test::turned(-phase(east, cell));
      power += p;
    }
    ++explained;
    of_several_cells += bin.size() > 1 ? 1 : 0;
    worst = std::max(worst, std::abs(east.voltage(b) - expected) / std::sqrt(power));
  }
  std::printf(
      "    %zu cells known from the south; %d bins explained from the east (%d of several cells), worst "
      "error %.1e\n",
      amplitude.size(), explained, of_several_cells, worst);
  EXPECT_GE(explained, 100);
  // Float32 voltages, twice 6e-8 of an amplitude of at most 5; ranges of 8 km in double give 4e-10 rad.
  EXPECT_LT(worst, 1e-6);
}

/// Phase by which the bins that hold one and the same face alone turned between two looks, against -4 pi
/// (r2 - r1) / lambda.
struct FaceTurns {
  int bins = 0, roofs = 0;
  double worst_rad = 0;  ///< measured less geometry
  double most_rad = 0;   ///< of the geometry's own turn
};

FaceTurns compare_faces(const World& world, const Look& before, const Look& after, double frequency_ghz) {
  FaceTurns turns;
  for (std::size_t b = 0; b < before.shares.size(); ++b) {
    if (before.shares[b].size() != 1 || after.shares[b].size() != 1) continue;
    const test::Cell& face = before.shares[b].begin()->first;
    if (face.face == kNoFace || face != after.shares[b].begin()->first) continue;
    const glm::dvec3 centre = test::reference_point_m(world, face);
    const long double geometry = test::round_trip_phase_rad(before.antenna_m, centre, frequency_ghz) -
                                 test::round_trip_phase_rad(after.antenna_m, centre, frequency_ghz);
    const double error = std::abs(std::arg(after.voltage(b) / before.voltage(b) * test::turned(-geometry)));
    ++turns.bins;
    turns.roofs += world.buildings.face(face.face).wall ? 0 : 1;
    turns.worst_rad = std::max(turns.worst_rad, error);
    turns.most_rad = std::max(turns.most_rad, static_cast<double>(std::abs(geometry)));
  }
  return turns;
}

TEST_P(CoherenceOfEverySource, APointScatterersPhaseFollowsGeometryWhenTheAntennaMovesACentimetre) {
  const auto scene = posts();
  for (const double frequency_ghz : {10.0, 35.0}) {
    RadarSettings s = settings(frequency_ghz);
    s.azimuth_bins = s.range_bins = 200;
    s.sector_deg = 40;
    s.r_min_m = 3700;
    s.r_max_m = 13700;
    s.pixel_columns = s.pixel_rows = 500;
    const glm::dvec3 at(3.25, 900.5, -7.75);
    const Look before(scene, s, pose_at(scene->world(), at, 0.02));
    for (const glm::dvec3& move : {glm::dvec3(0, 0, 0.01), glm::dvec3(0.01, 0, 0), glm::dvec3(0, 0.01, 0),
                                   glm::dvec3(-0.006, 0.0, -0.008)}) {
      const Look after(scene, s, pose_at(scene->world(), at + move, 0.02));
      const FaceTurns turns = compare_faces(scene->world(), before, after, frequency_ghz);
      std::printf(
          "    %g GHz, moved (%g, %g, %g) m: %d bins of one face (%d roofs), turned by up to %.3f rad, worst "
          "error %.1e rad\n",
          frequency_ghz, move.x, move.y, move.z, turns.bins, turns.roofs, turns.most_rad, turns.worst_rad);
      EXPECT_GE(turns.bins, 10);
      EXPECT_GE(turns.roofs, 2);
      EXPECT_LT(turns.worst_rad, 1e-3);
    }
  }
}

TEST_P(CoherenceOfEverySource, AnEighthOfAWavelengthAlongTheLineOfSightTurnsAPointByAQuarter) {
  const auto scene = posts();
  RadarSettings s = settings();
  s.azimuth_bins = s.range_bins = 200;
  s.sector_deg = 40;
  s.r_min_m = 3700;
  s.r_max_m = 13700;
  s.pixel_columns = s.pixel_rows = 500;
  const double lambda_m = 299792458.0 / 10e9;
  const glm::dvec3 at(3.25, 900.5, -7.75);
  const Look before(scene, s, pose_at(scene->world(), at, 0.02));
  int tried = 0;
  const Buildings& all = scene->world().buildings;
  for (std::uint32_t index = 0; index < all.building_of_face.size(); ++index) {
    const BuildingFace face = all.face(index);
    const auto alone = [&](const Look& look, std::size_t b) {
      return look.shares[b].size() == 1 && look.shares[b].begin()->first.face == index;
    };
    std::optional<std::size_t> bin;
    for (std::size_t b = 0; b < before.shares.size() && !bin; ++b)
      if (alone(before, b)) bin = b;
    if (!bin) continue;
    const glm::dvec3 step = glm::normalize(face.centre_m - at) * (lambda_m / 8);
    const Look after(scene, s, pose_at(scene->world(), at + step, 0.02));
    if (!alone(after, *bin)) continue;
    ++tried;
    EXPECT_NEAR(std::arg(after.voltage(*bin) / before.voltage(*bin)), std::numbers::pi / 2, 1e-3);
    if (tried == 8) break;
  }
  EXPECT_GE(tried, 5);
}

INSTANTIATE_TEST_SUITE_P(Sources, CoherenceOfEverySource, testing::ValuesIn(test::kEverySource),
                         test::source_name<testing::TestParamInfo<test::NamedSource>>);

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
}  // namespace obliq::speckle_coherence_test
