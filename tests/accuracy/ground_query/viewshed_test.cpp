// Lit and shadowed ground against the program gdal_viewshed, which steps through the raster on its own (Wang,
// Robinson and White 2000) and has no triangles. It runs on the elevation model as gdalwarp puts it
// on a local plane, without curvature, and is told the curvature as -cc 1/k; the renderer's side is a ray
// from the antenna to each post of the world grid, which is lit when nothing is in the way.
// Whether points are seen, and by what angle, against the reference renderer's own walk (server/truth), which
// shares no code with the query but the world.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <numbers>
#include <sstream>

#include "server/ground_query/ground_query.h"
#include "server/radar/profile/line_to_point.h"
#include "server/radar/profile/roofs.h"
#include "server/scene/embree_tracer.h"
#include "server/scene/exact_hit.h"
#include "server/truth/plane_walk.h"
#include "terrain/base/units.h"
#include "tests/support/figures.h"
#include "tests/support/random_scenes.h"
#include "tests/support/refine_hit.h"
#include "tests/support/scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq::viewshed_test {
namespace {

constexpr double kRadiusFactor = 4.0 / 3;

struct Survey {
  double longitude_deg, latitude_deg;  // the antenna, on a node and on the middle of a pixel
  double antenna_m;                    // above the datum
  double cell_m;
  int reach;  // cells to each side
};

std::string plane_of(const Survey& s) {
  std::ostringstream text;
  text.precision(12);
  text << "+proj=aeqd +lat_0=" << s.latitude_deg << " +lon_0=" << s.longitude_deg
       << " +datum=WGS84 +units=m +no_defs";
  return text.str();
}

void run(const std::string& command) {
  ASSERT_EQ(std::system((command + " >/dev/null").c_str()), 0) << command;
}

/// The first of the programs that this needs and that is not there; empty: all are.
std::string missing_program() {
  for (const char* name : {"gdal_viewshed", "gdallocationinfo", "gdal_translate", "gdalwarp"})
    if (std::system((std::string("command -v ") + name + " >/dev/null 2>&1").c_str()) != 0) return name;
  return {};
}

/// Skips by name where another program is missing.
class Viewshed : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string name = missing_program(); !name.empty())
      GTEST_SKIP() << "no " << name << " in PATH: gdal-bin has it (deploy/install-deps.sh)";
  }
};

/// gdal_viewshed's answer, [north to south][west to east], 1 where visible. `dem` lies on plane_of(s), its
/// middle pixel's middle at (0, 0).
std::vector<std::uint8_t> gdal_answer(const test::Folder& folder, const std::string& dem, const Survey& s) {
  FILE* pipe = popen(("gdallocationinfo -valonly -geoloc '" + dem + "' 0 0").c_str(), "r");
  double ground_m = NAN;
  if (!pipe || std::fscanf(pipe, "%lf", &ground_m) != 1) ADD_FAILURE() << "gdallocationinfo gave no height";
  if (pipe) pclose(pipe);
  std::ostringstream command;
  command.precision(12);
  command << "gdal_viewshed -q -ox 0 -oy 0 -oz " << s.antenna_m - ground_m
          << " -tz 0 -vv 1 -iv 0 -ov 255 -cc " << 1 / kRadiusFactor << " '" << dem << "' '"
          << folder.file("viewshed.tif") << "'";
  run(command.str());
  run("gdal_translate -q -of ENVI -ot Byte '" + folder.file("viewshed.tif") + "' '" +
      folder.file("viewshed.raw") + "'");
  std::ifstream file(folder.file("viewshed.raw"), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The renderer's answer in the same order; 255 where no ground is known.
std::vector<std::uint8_t> own_answer(const World& world, const Survey& s) {
  const HeightGrid& grid = world.grid;
  const EmbreeTracer tracer(world, 0, {});
  const glm::dvec3 antenna(0, s.antenna_m, 0);
  const int side = 2 * s.reach + 1;
  std::vector<std::uint8_t> lit(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 255);
  std::vector<double> x, y, z, distance;
  std::vector<std::size_t> cell;
  for (int north = s.reach; north >= -s.reach; --north) {
    for (int east = -s.reach; east <= s.reach; ++east) {
      const int i = static_cast<int>(std::lround((east * s.cell_m - grid.x0_m) / s.cell_m));
      const int j = static_cast<int>(std::lround((north * s.cell_m - grid.z0_m) / s.cell_m));
      if (i < 0 || j < 0 || i >= grid.nx || j >= grid.nz || !grid.node_known(i, j)) continue;
      const glm::dvec3 to = glm::dvec3(grid.node_x_m(i), grid.node_y_m(i, j), grid.node_z_m(j)) - antenna;
      const double length = glm::length(to);
      x.push_back(to.x / length);
      y.push_back(to.y / length);
      z.push_back(to.z / length);
      distance.push_back(length);
      cell.push_back(static_cast<std::size_t>(s.reach - north) * static_cast<std::size_t>(side) +
                     static_cast<std::size_t>(east + s.reach));
    }
  }
  std::vector<RoughHit> rough(x.size());
  tracer.trace(antenna, x.data(), y.data(), z.data(), static_cast<int>(x.size()), rough.data());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const glm::dvec3 direction(x[k], y[k], z[k]);
    auto hit = test::refine_hit(world, antenna, direction, rough[k]);
    // Rays aimed exactly at vertices may slip through the mesh there: ask the slow walk.
    if (!hit) hit = walk_ground(world, antenna, direction, 0, distance[k]);
    // The post itself lies on the surface: what stops the ray within a metre of it is its own slope.
    lit[cell[k]] = !hit || hit->slant_range_m > distance[k] - 1 ? 1 : 0;
  }
  return lit;
}

/// Ground queries' answer in the same order.
std::vector<std::uint8_t> query_answer(World world, const Survey& s) {
  const auto scene = test::make_scene(std::move(world));
  const GroundQuery query(*scene);
  const HeightGrid& grid = scene->world().grid;
  Pose antenna;
  antenna.antenna.m = {0.0, s.antenna_m, 0.0};
  std::vector<std::uint8_t> lit;
  for (int north = s.reach; north >= -s.reach; --north) {
    for (int east = -s.reach; east <= s.reach; ++east) {
      const double x = east * s.cell_m, z = north * s.cell_m;
      const double y = grid.height_at_m(x, z);
      const Geodetic at = scene->world().frame.geodetic_from_world({glm::dvec3(x, std::isnan(y) ? 0 : y, z)});
      const auto got =
          query.answer(at.latitude_rad / kDegree_rad, at.longitude_rad / kDegree_rad, {}, &antenna);
      lit.push_back(std::isnan(y) ? 255 : got.sight == wire::Sight::behind_ground ? 0 : 1);
    }
  }
  return lit;
}

struct Agreement {
  int all = 0, same = 0;
  int inner = 0, inner_same = 0;  ///< more than one cell from an edge of gdal_viewshed's shadows
  int shadowed = 0;
};

/// own is looked up `shift` columns to the east.
Agreement agreement(const std::vector<std::uint8_t>& gdal, const std::vector<std::uint8_t>& own,
                    const Survey& s, int shift) {
  const int side = 2 * s.reach + 1;
  const auto at = [&](int row, int column) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(side) + static_cast<std::size_t>(column);
  };
  Agreement n;
  for (int row = 1; row + 1 < side; ++row) {
    for (int column = 1; column + 1 + shift < side; ++column) {
      const std::uint8_t theirs = gdal[at(row, column)];
      const std::uint8_t ours = own[at(row, column + shift)];
      if (theirs > 1 || ours > 1) continue;
      bool edge = false;
      for (int r = row - 1; r <= row + 1; ++r)
        for (int c = column - 1; c <= column + 1; ++c) edge |= gdal[at(r, c)] != theirs;
      ++n.all;
      n.same += theirs == ours ? 1 : 0;
      n.inner += edge ? 0 : 1;
      n.inner_same += !edge && theirs == ours ? 1 : 0;
      n.shadowed += theirs == 0 ? 1 : 0;
    }
  }
  return n;
}

void compare(const std::vector<std::uint8_t>& gdal, const std::vector<std::uint8_t>& own, const Survey& s) {
  ASSERT_EQ(gdal.size(), own.size());
  const Agreement n = agreement(gdal, own, s, 0);
  std::printf("    %d cells, %.1f %% in shadow; %.2f %% of all agree, %.2f %% of the %d off shadow edges\n",
              n.all, 100.0 * n.shadowed / n.all, 100.0 * n.same / n.all, 100.0 * n.inner_same / n.inner,
              n.inner);
  test::record_figure("viewshed_same", static_cast<double>(n.same) / n.all);
  test::record_figure("viewshed_inner_same", static_cast<double>(n.inner_same) / n.inner);
  EXPECT_GT(n.all, 100000);
  EXPECT_GT(n.shadowed, n.all / 20);
  EXPECT_GT(n.all - n.shadowed, n.all / 20);
  EXPECT_GE(n.inner_same, 0.995 * n.inner);
  EXPECT_GE(n.same, 0.97 * n.all);
  // The comparison can fail: ground that lies two cells off does.
  const Agreement shifted = agreement(gdal, own, s, 2);
  std::printf("    shifted by two cells: %.2f %% and %.2f %%\n", 100.0 * shifted.same / shifted.all,
              100.0 * shifted.inner_same / shifted.inner);
  EXPECT_LT(shifted.inner_same, 0.995 * shifted.inner);
  EXPECT_LT(shifted.same, 0.97 * shifted.all);
}

void compare_dem(const char* name, const Survey& s) {
  const std::string dem = test::shared_file(name);
  if (dem.empty()) GTEST_SKIP() << test::no_shared_file(name);
  const test::Folder folder;
  const double half = (s.reach + 0.5) * s.cell_m;
  std::ostringstream warp;
  warp.precision(12);
  warp << "gdalwarp -q -r bilinear -ot Float32 -t_srs '" << plane_of(s) << "' -te " << -half << " " << -half
       << " " << half << " " << half << " -tr " << s.cell_m << " " << s.cell_m << " '" << dem << "' '"
       << folder.file("plane.tif") << "'";
  run(warp.str());
  WorldSpec spec = test::scene(s.longitude_deg, s.latitude_deg, 1.5 * half, {dem});
  spec.radius_factor = kRadiusFactor;
  spec.terrain.cell_m = s.cell_m;
  const auto gdal = gdal_answer(folder, folder.file("plane.tif"), s);
  World world = load_world(spec);
  compare(gdal, own_answer(world, s), s);
  compare(gdal, query_answer(std::move(world), s), s);
}

TEST_F(Viewshed, OfTheSanGabrielMountainsAgreesWithGdalViewshed) {
  compare_dem("la_nasadem_30m/NASADEM_HGT_n34w119.tif", {-118.15, 34.3, 2200, 30, 400});
}

TEST_F(Viewshed, OfLargoCanyonAgreesWithGdalViewshed) {
  compare_dem("nm_ned13_10m/USGS_NED_13_n37w108_Clipped.tif", {-107.585, 36.4, 2350, 10, 600});
}

TEST_F(Viewshed, OfHillsAgreesWithGdalViewshed) {
  const Survey s{-99.5, 33, 900, 40, 300};
  const test::Folder folder;
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 18000, s.cell_m);
  spec.terrain.shape.height_m = 1200;
  spec.radius_factor = kRadiusFactor;
  World world = load_world(spec);
  test::RasterPlan plan;
  plan.crs = plane_of(s);
  plan.columns = plan.rows = 2 * s.reach + 1;
  const double half = (s.reach + 0.5) * s.cell_m;
  plan.geotransform = {-half, s.cell_m, 0, half, 0, -s.cell_m};
  plan.value = [&](double east, double north) {
    // The curvature taken out again, on a sphere: within a decimetre over 17 km.
    const double sphere_m = 6371008.8 * kRadiusFactor;
    return world.grid.height_at_m(east, north) + (east * east + north * north) / (2 * sphere_m);
  };
  const std::string dem = test::write_raster(folder, "plane.tif", plan);
  const auto gdal = gdal_answer(folder, dem, s);
  compare(gdal, own_answer(world, s), s);
  compare(gdal, query_answer(std::move(world), s), s);
}

using wire::Sight;

/// The greatest tangent of elevation of what the reference sees before a distance.
long double reference_horizon(const std::vector<Strip>& lit, double d_m) {
  long double highest = -HUGE_VALL;
  const auto raise = [&](long double d, long double h) {
    if (d > 0) highest = std::max(highest, h / d);
  };
  for (const Strip& strip : lit) {
    if (strip.d0_m >= d_m) continue;
    const long double share =
        strip.d1_m > d_m ? (d_m - static_cast<long double>(strip.d0_m)) / (strip.d1_m - strip.d0_m) : 1;
    raise(strip.d0_m, strip.h0_m);
    raise(strip.d0_m + share * (strip.d1_m - strip.d0_m), strip.h0_m + share * (strip.h1_m - strip.h0_m));
  }
  return highest;
}

struct Tally {
  int seen = 0, hidden = 0, by_buildings = 0, inside = 0, wrong_if_raised = 0;
};

class Comparison {
 public:
  Comparison(const std::shared_ptr<const Scene>& scene, const Pose& pose, const std::string& text)
      : scene_(scene), world_(scene->world()), pose_(pose), text_(text), query_(*scene) {
    view_.antenna_m = pose.antenna.m;
    view_.sector_rad = 2 * std::numbers::pi;
    view_.azimuth_bins = 1;
    view_.r_max_m = 1e6;
    view_.range_bins = 1;
  }

  void compare(double bearing_rad, test::Dice& dice, int points, Tally& tally) const {
    const SightedBuildings sighted(world_.buildings, view_, 0, 1);
    PlaneWalk walk(world_, sighted, view_);
    PlaneStrips strips;
    walk.walk(bearing_rad, 0, strips);
    const double reach = 1.5 * world_.grid.cell_m * std::max(world_.grid.nx, world_.grid.nz);
    for (int k = 0; k < points; ++k) {
      const double d = dice.uniform(0.01, 1) * reach;
      const double x = pose_.antenna.m.x + d * std::sin(bearing_rad);
      const double z = pose_.antenna.m.z + d * std::cos(bearing_rad);
      const double ground = world_.grid.height_at_m(x, z);
      if (std::isnan(ground)) continue;
      const double over = dice.chance(0.5) ? 0 : dice.logarithmic(0.01, 100);
      look_at({x, ground + over, z}, d, reference_horizon(strips.lit, d), tally);
    }
  }

 private:
  void look_at(const glm::dvec3& point, double d, long double horizon, Tally& tally) const {
    const Geodetic at = world_.frame.geodetic_from_world({point});
    const wire::GroundRecord got =
        query_.answer(at.latitude_rad / kDegree_rad, at.longitude_rad / kDegree_rad,
                      {at.height_m, HeightReference::datum, 0}, &pose_);
    const auto roof = roof_above(world_.buildings, point);
    if (roof && *roof > point.y + 2 * kOnSurface_m) {
      EXPECT_EQ(got.sight, Sight::inside_building) << text_;
      ++tally.inside;
      return;
    }
    const double above = point.y - pose_.antenna.m.y;
    const auto hidden_m = static_cast<double>(horizon * d - above);
    const bool hidden = got.sight == Sight::behind_ground || got.sight == Sight::behind_building;
    if (std::abs(hidden_m - kOnSurface_m) < kOnSurface_m / 2 || (roof && *roof > point.y)) return;
    ASSERT_TRUE(hidden || got.sight == Sight::visible) << static_cast<int>(got.sight) << ' ' << text_;
    EXPECT_EQ(hidden, hidden_m > kOnSurface_m)
        << hidden_m << " m under the horizon at " << d << " m, " << text_;
    const double expected = std::atan2(above, d) - static_cast<double>(std::atan(horizon));
    // Floats of up to 180 degrees.
    EXPECT_NEAR(got.clearance_deg, std::max(expected, hidden ? -HUGE_VAL : 0.0) / kDegree_rad, 2e-5) << text_;
    (hidden ? tally.hidden : tally.seen) += 1;
    tally.by_buildings += got.sight == Sight::behind_building ? 1 : 0;
    // A metre more would be seen as often as not: the comparison can fail.
    tally.wrong_if_raised += hidden_m > kOnSurface_m && hidden_m - 1 <= kOnSurface_m ? 1 : 0;
  }

  std::shared_ptr<const Scene> scene_;
  const World& world_;
  Pose pose_;
  std::string text_;
  GroundQuery query_;
  ReferenceView view_;
};

Tally compare_scenes(const test::RandomSceneOptions& options, int scenes, int planes, int points) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scenes); ++seed) {
    test::RandomScene random = test::random_scene(seed, options);
    const Pose pose = random.pose;
    const std::string text = random.text;
    const Comparison comparison(test::scene_of(random), pose, text);
    test::Dice dice(seed + 77);
    for (int k = 0; k < planes; ++k)
      comparison.compare(dice.uniform(0, 2 * std::numbers::pi), dice, points, tally);
  }
  std::printf("    %d seen, %d hidden, of those %d by buildings, %d inside one\n", tally.seen, tally.hidden,
              tally.by_buildings, tally.inside);
  return tally;
}

TEST(GroundSight, IsThatOfTheReferenceInRandomScenes) {
  const Tally tally = compare_scenes({.voids = false, .outside = false}, 150, 12, 20);
  EXPECT_GT(tally.seen, 3000);
  EXPECT_GT(tally.hidden, 1000);
  EXPECT_GT(tally.by_buildings, 50);
  EXPECT_GT(tally.inside, 50);
  EXPECT_GT(tally.wrong_if_raised, 100);
}

TEST(GroundSight, IsThatOfTheReferenceOverGridsOfManySquares) {
  // Bounds on several levels: 700 nodes a side are 88 of the smallest squares.
  const Tally tally =
      compare_scenes({.nodes = 700, .most_prisms = 300, .voids = false, .outside = false}, 6, 60, 20);
  EXPECT_GT(tally.seen, 500);
  EXPECT_GT(tally.hidden, 300);
}

}  // namespace
}  // namespace obliq::viewshed_test
