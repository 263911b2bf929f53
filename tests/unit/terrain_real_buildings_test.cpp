// Real outlines. They are not part of the project: without them, skipped.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "tests/support/parts_check.h"
#include "tests/unit/terrain_outlines.h"

namespace obliq {
namespace {

struct City {
  const char* name;
  const char* dem;
  const char* outlines;
  const char* height_field;
  double longitude_deg, latitude_deg, reach_m;
  std::uint64_t features;
  double least_kept;
};

/// What a listing of the tests shows of the parameter.
void PrintTo(const City& value, std::ostream* out) { *out << value.name; }

class RealCity : public testing::TestWithParam<City> {};

TEST_P(RealCity, EveryPrismIsAClosedSolidOfItsFootprintAndHeight) {
  const City& city = GetParam();
  const std::string dem = test::shared_file(city.dem);
  const std::string outlines = test::shared_file(city.outlines);
  if (dem.empty() || outlines.empty()) {
    GTEST_SKIP() << "no shared data: set OBLIQ_SHARED to the folder that holds data/" << city.outlines;
  }
  WorldSpec spec = test::scene(city.longitude_deg, city.latitude_deg, city.reach_m, {dem});
  spec.radius_factor = 4.0 / 3;
  spec.buildings.emplace_back();
  spec.buildings[0].source = outlines;
  spec.buildings[0].height_field = city.height_field;
  const World world = load_world(spec);
  const LoadReport& r = world.report;
  std::printf(
      "%s: read %lu kept %lu repaired %lu zero %lu duplicate %lu outside %lu no ground %lu unusable %lu\n",
      city.name, r.buildings_read, r.buildings_kept, r.buildings_repaired, r.buildings_zero_area,
      r.buildings_duplicate, r.buildings_outside, r.buildings_no_ground, r.buildings_unusable);
  EXPECT_EQ(r.buildings_read, city.features);
  EXPECT_GT(static_cast<double>(r.buildings_kept), city.least_kept * static_cast<double>(city.features));
  for (std::size_t k = 0; k < world.buildings.list.size(); ++k) {
    const Building& building = world.buildings.list[k];
    const double area = test::roof_area_m2(world.buildings, k);
    const double height = static_cast<double>(building.roof_y_m) - static_cast<double>(building.base_y_m);
    ASSERT_GT(area, 0);
    ASSERT_GT(height, 0);
    ASSERT_NEAR(test::enclosed_volume_m3(world.buildings, k), area * height, 1e-6 * area * height) << k;
    test::expect_parts_make_up(world.buildings, static_cast<std::uint32_t>(k),
                               "building " + std::to_string(k));
  }
  std::printf("%zu buildings are cut into %zu convex parts\n",
              static_cast<std::size_t>(std::ranges::count_if(
                  world.buildings.list, [](const Building& b) { return b.n_parts > 0; })),
              world.buildings.parts.size());
}

INSTANTIATE_TEST_SUITE_P(Cities, RealCity,
                         testing::Values(City{"SanFrancisco", "sf_city/sf_3dep_resampled_30m_utm10n.tif",
                                              "sf_city/sf_buildings_heights_from_mvt.geojson", "height",
                                              -122.435, 37.77, 12000, 13896, 0.95},
                                         City{"LosAngeles", "la_nasadem_30m/NASADEM_HGT_n34w119.tif",
                                              "la_city/la_buildings_in_nasadem_tile_metres.geojson",
                                              "height_m", -118.45, 34.05, 46250, 5434, 0.9}),
                         [](const testing::TestParamInfo<City>& given) {
                           return std::string(given.param.name);
                         });

}  // namespace
}  // namespace obliq
