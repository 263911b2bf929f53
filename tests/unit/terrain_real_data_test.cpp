// Elevation models as they come from agencies. They are not part of the project: without them, skipped.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "tests/unit/terrain_files.h"

namespace obliq {
namespace {

struct RealFile {
  const char* name;
  double lowest_m, highest_m;  // of the whole file, by gdalinfo
  const char* crs = "";
  VerticalUnit unit = VerticalUnit::metre;
  bool override_unit = false;
};

/// What a listing of the tests shows of the parameter.
void PrintTo(const RealFile& value, std::ostream* out) { *out << value.name; }

class RealDem : public testing::TestWithParam<RealFile> {};

TEST_P(RealDem, LoadsWholeWithHeightsInItsRange) {
  const RealFile& real = GetParam();
  const std::string dem = test::shared_file(real.name);
  if (dem.empty())
    GTEST_SKIP() << "no shared data: set OBLIQ_SHARED to the folder that holds data/" << real.name;
  WorldSpec spec = test::scene(0, 0, 1, {dem});
  if (*real.crs) spec.terrain.crs = real.crs;
  if (real.override_unit) spec.terrain.unit = real.unit;
  spec.origin = dem_centre(spec.terrain);
  spec.reaches.clear();
  const World world = load_world(spec);
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (float y : world.grid.y_m) {
    if (std::isnan(y)) continue;
    low = std::min(low, static_cast<double>(y));
    high = std::max(high, static_cast<double>(y));
  }
  // Interpolated between posts: inside the range, and most of the way to its ends.
  EXPECT_GE(low, real.lowest_m - 0.01);
  EXPECT_LE(high, real.highest_m + 0.01);
  EXPECT_GT(high - low, 0.85 * (real.highest_m - real.lowest_m));
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealDem,
    testing::Values(RealFile{"nm_ned13_10m/USGS_NED_13_n37w108_Clipped.tif", 1834.2, 2278.6},
                    RealFile{"fortworth_tx_90m/dem.tif", 147, 298},
                    RealFile{"houston_tx_3dep_10m/dem_tx_10m.tif", 0, 22.5},
                    RealFile{"sf_city/sf_3dep_resampled_30m_utm10n.tif", -5.6, 282.8},
                    RealFile{"sf_city/San_Fran_North.dem", 0, 343},
                    RealFile{"sf_city/sanfranciscos.dem", 0, 1314 * 0.3048},  // tagged in feet
                    RealFile{"az_utm_vertfeet/dem.tif", 4029 * 0.3048, 6458 * 0.3048, "", VerticalUnit::foot,
                             true},
                    RealFile{"nh_gridfloat_ned/PresRange_1as.flt", 415.7, 1916.5},
                    RealFile{"small/sagehen_dem10m.img", 1920.4, 2663.3},
                    RealFile{"small/faultzone.tif", 631.6, 700, "EPSG:32611"},
                    RealFile{"small/hugo_site.asc", 1660, 1711, "EPSG:26913"},
                    RealFile{"small/osmnx_elevation2.tif", -35, 118},
                    RealFile{"small/elevation_pkg_GLO-90_nw_san_francisco.tif", -6.2, 198.5},
                    RealFile{"small/elevation_pkg_SRTM3_nw_san_francisco.tif", -16, 193},
                    RealFile{"windninja_usfs/mackay.tif", 1732.5, 3645.4},
                    RealFile{"windninja_usfs/some_nodata.tif", 1733.1, 3602.9}),
    [](const testing::TestParamInfo<RealFile>& given) {
      std::string name = given.param.name;
      std::replace_if(
          name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
      return name;
    });

}  // namespace
}  // namespace obliq
