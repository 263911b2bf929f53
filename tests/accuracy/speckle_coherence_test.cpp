// Ground speckle of whole frames belongs to the ground: from any pose a cell answers with the same amplitude,
// and from pose to pose the phase of faces and cells follows the geometry. Geometry is worked out here in
// long double from the poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "terrain/buildings/footprints.h"
#include "tests/support/scatterer_shares.h"
#include "tests/support/scenes.h"
#include "tests/support/sources.h"

namespace obliq {
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
    turns.roofs += world.buildings.faces[face.face].wall ? 0 : 1;
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
  for (const BuildingFace& face : scene->world().buildings.faces) {
    const auto index = static_cast<std::uint32_t>(&face - scene->world().buildings.faces.data());
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

}  // namespace
}  // namespace obliq
