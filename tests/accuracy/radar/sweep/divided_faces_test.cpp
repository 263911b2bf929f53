// A face that an edge of bins divides is one scatterer: the coherent sum over its bins has the sum of their
// powers, whatever the seed.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq::divided_faces_test {
namespace {

constexpr double kRange_m = 1000;

struct Divided {
  const char* name;
  double left_m;   // of the wall's front: from there to a metre further right
  double slant_m;  // by how much farther off its right end is
  double edge_m;   // of a range bin
  int bins;        // that hold some of it
};

/// A wedge of a house, lower than a metre and a half, of which an antenna a metre high sees one wall.
std::shared_ptr<const Scene> house(const Divided& wall) {
  World world = test::made_world(4000, 50, [](double, double) { return 0; });
  const glm::dvec2 a(wall.left_m, kRange_m), b(wall.left_m + 1, kRange_m + wall.slant_m);
  test::add_prism(world, {a, b, {(a.x + b.x) / 2, b.y + 0.7}}, 1.5);
  return test::make_scene(std::move(world));
}

RadarSettings settings_of(const Divided& wall, int planes, int sub_columns) {
  RadarSettings s;
  s.frustum = FrustumKind::sweep;
  s.sector_deg = 8;
  s.azimuth_bins = 16;
  s.range_bins = 32;
  s.r_min_m = wall.edge_m - 16 * 10;
  s.r_max_m = wall.edge_m + 16 * 10;
  s.pixel_columns = planes * s.azimuth_bins;
  s.sub_columns = sub_columns;
  return s;
}

struct Sums {
  std::complex<double> iq;
  double power_w = 0;
  int bins = 0;
};

BinBlock frame_of(const Scene& scene, const std::shared_ptr<const Scene>& owned, const RadarSettings& s) {
  RenderOptions options;
  options.surfaces = Surfaces::buildings;
  return render(owned, test::snapshot(s), test::pose_at(scene.world(), {0, 1, 0}, 0), {0, s.azimuth_bins},
                options)
      .bins;
}

constexpr Divided kWalls[] = {{"none", 1, 0, kRange_m - 3, 1},
                              {"azimuth", -0.3, 0, kRange_m - 3, 2},
                              {"range", 1, 0.6, kRange_m + 0.2, 2},
                              {"azimuth and range", -0.4, 0.6, kRange_m + 0.2405, 2}};

TEST(DividedFaces, AreOneScattererInSharpBins) {
  for (const Divided& wall : kWalls) {
    const auto scene = house(wall);
    for (const int sub_columns : {64, 0}) {
      SCOPED_TRACE(std::string(wall.name) + (sub_columns == 0 ? ", exact" : ""));
      for (int seed = 1; seed <= 20; ++seed) {
        RadarSettings s = settings_of(wall, 2, sub_columns);
        s.speckle_seed = seed;
        Sums sums;
        const BinBlock bins = frame_of(*scene, scene, s);
        for (std::size_t k = 0; k < bins.power_w.size(); ++k) {
          if (!(bins.power_w[k] > 0)) continue;
          ++sums.bins;
          sums.iq += std::complex<double>(bins.iq[k]);
          sums.power_w += bins.power_w[k];
          EXPECT_NEAR(static_cast<double>(std::norm(bins.iq[k])) / bins.power_w[k], 1, 1e-5);
        }
        EXPECT_GE(sums.bins, wall.bins);
        EXPECT_NEAR(std::norm(sums.iq) / sums.power_w, 1, wall.bins == 1 || sums.bins == 2 ? 1e-5 : 0.1);
      }
    }
  }
}

TEST(DividedFaces, AreOneScattererBehindABeamAndAPulse) {
  for (const Divided& wall : kWalls) {
    const auto scene = house(wall);
    for (const int sub_columns : {64, 0}) {
      SCOPED_TRACE(std::string(wall.name) + (sub_columns == 0 ? ", exact" : ""));
      for (int seed = 1; seed <= 20; ++seed) {
        RadarSettings s = settings_of(wall, 2, sub_columns);
        s.beam.pattern = BeamPattern::gaussian;
        s.beam.width_deg = 3;
        s.pulse.kind = PulseKind::compressed;
        s.speckle_seed = seed;
        const BinBlock bins = frame_of(*scene, scene, s);
        const std::size_t peak = static_cast<std::size_t>(
            std::max_element(bins.power_w.begin(), bins.power_w.end()) - bins.power_w.begin());
        EXPECT_GT(bins.power_w[peak], 0);
        EXPECT_NEAR(static_cast<double>(std::norm(bins.iq[peak])) / bins.power_w[peak], 1, 0.01);
      }
    }
  }
}

}  // namespace
}  // namespace obliq::divided_faces_test
