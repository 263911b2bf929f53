// Ground with a gamma raster: fields show in the power of bins as much as the raster says, in the sweep, in
// its exact planes, in rays and in the reference.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "server/accuracy/bin_errors.h"
#include "server/radar/render.h"
#include "tests/accuracy/reference_support.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::gamma_raster_test {
namespace {

struct Way {
  const char* name;
  FrustumKind frustum;
  int sub_columns;
  PlateKind plates;
};
constexpr Way kWays[] = {{"sweep", FrustumKind::sweep, 16, PlateKind::nearest},
                         {"exact planes", FrustumKind::sweep, 0, PlateKind::nearest},
                         {"rays", FrustumKind::oblique, 0, PlateKind::nearest},
                         {"spread rays", FrustumKind::oblique, 0, PlateKind::spread}};

/// Ground of constant gamma and of geometric optics.
std::vector<Material> materials(ScatteringModel ground) {
  std::vector<Material> list = test::two_materials();
  list[0].gamma = 0.03;
  list[0].model = ground;
  list[0].rms_slope = 0.5;
  return list;
}

RadarSettings settings_of(const Way& way) {
  RadarSettings s = test::radar_settings(way.frustum, {1500, 6000, 40}, {20, 40}, {640, 900});
  s.sub_columns = way.sub_columns;
  s.plates = way.plates;
  return s;
}

BinBlock bins_of(const std::shared_ptr<const Scene>& scene, const RadarSettings& s, int threads = 2) {
  RenderOptions options;
  options.threads = threads;
  return render(scene, test::snapshot(s), test::pose_at(scene->world(), {0, 1500, 0}, 0), {0, s.azimuth_bins},
                options)
      .bins;
}

/// Level ground 9 km around, what a raster says by a function of world x and z.
World level_world(const std::function<float(double, double)>& raster_gamma) {
  World world = test::made_world(8000, 50, [](double, double) { return 0; });
  for (int j = 0; j < world.grid.nz - 1; ++j)
    for (int i = 0; i < world.grid.nx - 1; ++i)
      world.raster_gamma.push_back(raster_gamma(world.grid.node_x_m(i) + 25, world.grid.node_z_m(j) + 25));
  return world;
}

TEST(GammaRaster, FieldsShowAsMuchAsTheRasterSays) {
  // East of the antenna's meridian 3 dB more; west of it gamma -10 dB in the material's place.
  const World with = level_world([](double x, double) { return x > 0 ? 1.9952623F : -0.1F; });
  World without = with;
  without.raster_gamma.clear();
  const double east = std::pow(10, 0.3);
  for (const ScatteringModel model : {ScatteringModel::constant_gamma, ScatteringModel::geometric_optics})
    for (const Way& way : kWays) {
      std::vector<Material> tenth = materials(ScatteringModel::constant_gamma);
      tenth[0].gamma = 0.1;
      const RadarSettings s = settings_of(way);
      const BinBlock plain = bins_of(test::make_scene(without, materials(model)), s);
      const BinBlock of_tenth = bins_of(test::make_scene(without, tenth), s);
      const BinBlock found = bins_of(test::make_scene(with, materials(model)), s);
      for (std::size_t azimuth = 0; azimuth < 20; ++azimuth)
        for (std::size_t range = 0; range < 40; ++range) {
          const std::size_t bin = azimuth * 40 + range;
          if (!(plain.power_w[bin] > 0)) continue;
          const double expected = azimuth < 10 ? of_tenth.power_w[bin] : east * plain.power_w[bin];
          // Floats in the sweep. The issue asks for 1e-3.
          ASSERT_NEAR(found.power_w[bin] / expected, 1, 2e-6) << way.name << " " << azimuth << " " << range;
        }
    }
}

TEST(GammaRaster, SweepRaysAndReferenceAgreeOverHillsOfManyFields) {
  World world = test::made_world(8000, 50, test::hills_m);
  // Fields of 150 m, of -9 to 9 dB, or of gamma -20 to -4 dB; some without a value.
  for (int j = 0; j < world.grid.nz - 1; ++j)
    for (int i = 0; i < world.grid.nx - 1; ++i) {
      const int field = (i / 3 * 7 + j / 3 * 11) % 10;
      world.raster_gamma.push_back(field == 9  ? 1.0F
                                   : field > 4 ? -static_cast<float>(std::pow(10, -2 + 0.4 * (field - 4)))
                                               : static_cast<float>(std::pow(10, -0.9 + 0.45 * field)));
    }
  World without = world;
  without.raster_gamma.clear();
  for (const ScatteringModel model : {ScatteringModel::constant_gamma, ScatteringModel::geometric_optics}) {
    const std::vector<Material> list = materials(model);
    for (const Way& way : kWays) {
      const RadarSettings s = settings_of(way);
      ReferenceView view =
          test::view_from({0, 1500, 0}, 0, s.sector_deg, s.azimuth_bins, s.r_min_m, s.r_max_m, s.range_bins);
      view.wavelength_m = 299792458.0 / (s.frequency_ghz * 1e9);
      view.power_w = s.power_w;
      view.gain = std::pow(10, s.gain_db / 10);
      view.range_normalisation = s.range_normalisation;
      const RangeBins ranges{s.r_min_m, (s.r_max_m - s.r_min_m) / s.range_bins, s.range_bins,
                             s.range_normalisation};
      const auto error = [&](const World& of) {
        const ReferenceBins truth = test::integrate_all(of, list, view, {64, 2, 0});
        return bin_errors(bins_of(test::make_scene(of, list), s).power_w, truth.ground_w, ranges).power_error;
      };
      const double plain = error(without);
      const double fields = error(world);
      std::printf("    %-12s %s: power error %.4f, without the raster %.4f\n", way.name,
                  model == ScatteringModel::constant_gamma ? "gamma" : "lobes", fields, plain);
      // What the planes or pixels of a bin miss of ground that changes by 27 dB from field to field; a
      // version that leaves the raster out, or adds decibels where gamma is meant, is off by 0.9.
      EXPECT_LT(fields, plain + (way.frustum == FrustumKind::sweep ? 0.004 : 0.06)) << way.name;
    }
  }
}

TEST(GammaRaster, HasTheSameBitsOnAnyNumberOfThreads) {
  World world = level_world([](double x, double z) {
    return static_cast<float>(std::pow(10, std::sin(x / 90) * std::cos(z / 70)));
  });
  const auto scene = test::make_scene(world, materials(ScatteringModel::constant_gamma));
  for (const Way& way : kWays) {
    const BinBlock one = bins_of(scene, settings_of(way), 1);
    for (const int threads : {2, 8}) test::expect_same_bits(one, bins_of(scene, settings_of(way), threads));
  }
}

TEST(GammaRaster, OfOnesHasTheBitsOfNone) {
  World world = test::made_world(8000, 50, test::hills_m);
  const auto none = test::make_scene(world, materials(ScatteringModel::geometric_optics));
  world.raster_gamma.assign(
      static_cast<std::size_t>(world.grid.nx - 1) * static_cast<std::size_t>(world.grid.nz - 1), 1.0F);
  const auto ones = test::make_scene(world, materials(ScatteringModel::geometric_optics));
  for (const Way& way : kWays)
    test::expect_same_bits(bins_of(none, settings_of(way)), bins_of(ones, settings_of(way)));
}

}  // namespace
}  // namespace obliq::gamma_raster_test
