// What stays the same when the loaded window moves, and when the scene's origin does.
#include <gtest/gtest.h>

#include <cstring>

#include "server/flight/window.h"
#include "terrain/base/units.h"
#include "tests/support/scenes.h"

namespace obliq::test {
namespace {

constexpr double kDegree_m = 111195;  // of a meridian, near enough

/// Hills with buildings in places that the file gives on the earth.
SceneConfig hills() {
  SceneConfig config;
  config.world = synthetic_spec(SyntheticKind::hills, 6000, 40);
  config.world.terrain.shape.height_m = 300;
  config.world.radius_factor = 4.0 / 3;
  PrismSpec prisms;
  prisms.per_km2 = 20;
  config.world.prisms = {prisms};
  config.materials = two_materials();
  config.radars.emplace_back();
  config.radars[0].settings.r_max_m = 5000;
  return config;
}

SceneConfig moved(const SceneConfig& config, double east_m, double north_m, bool with_origin) {
  SceneWindow window = window_of(config);
  LonLat& centre = window.reaches[0].centre;
  centre.longitude_deg += east_m / (kDegree_m * std::cos(centre.latitude_deg * kDegree_rad));
  centre.latitude_deg += north_m / kDegree_m;
  if (with_origin) window.origin = centre;
  return aimed_at(config, window);
}

std::shared_ptr<const Scene> built(const SceneConfig& config) {
  return make_scene(load_world(config.world), config.materials);
}

Frame frame_at(const std::shared_ptr<const Scene>& scene, const PoseSettings& pose, FrustumKind kind) {
  RadarSettings settings;
  settings.frustum = kind;
  settings.r_min_m = 1000;
  settings.r_max_m = 3000;
  settings.pixel_columns = settings.pixel_rows = 128;
  settings.azimuth_bins = settings.range_bins = 64;
  std::vector<FieldError> errors;
  const auto placed = place_antenna(scene->world(), pose, errors);
  EXPECT_TRUE(placed);
  return render(scene, snapshot(settings), *placed, {0, settings.azimuth_bins});
}

TEST(FlightWindows, AMovedWindowOfTheSameOriginGivesTheSameBitsWhereBothReach) {
  const SceneConfig config = hills();
  const auto before = built(config);
  const auto after = built(moved(config, 1500, 1100, false));
  PoseSettings pose;
  pose.latitude_deg = 33.003;
  pose.longitude_deg = -99.492;
  pose.height_m = 800;
  // Pixels of the ray frusta are laid out by the heights in view, of which windows sample others.
  const Frame a = frame_at(before, pose, FrustumKind::sweep);
  const Frame b = frame_at(after, pose, FrustumKind::sweep);
  EXPECT_GT(a.stats.samples, 1000u);
  EXPECT_EQ(std::memcmp(a.bins.iq.data(), b.bins.iq.data(), a.bins.iq.size() * sizeof a.bins.iq[0]), 0);
  EXPECT_EQ(a.bins.state, b.bins.state);
}

TEST(FlightWindows, AWindowIsTheSameWhateverWasLoadedBefore) {
  const SceneConfig config = hills();
  const SceneConfig direct = moved(config, 9000, 0, true);
  const SceneConfig by_way = aimed_at(moved(config, 4000, 2000, true), window_of(direct));
  const World a = load_world(direct.world);
  const World b = load_world(by_way.world);
  EXPECT_EQ(a.grid.y_m, b.grid.y_m);
  ASSERT_EQ(a.buildings.list.size(), b.buildings.list.size());
  EXPECT_GT(a.buildings.list.size(), 100u);
}

TEST(FlightWindows, HillsStayOnTheEarthWhenTheOriginMoves) {
  const SceneConfig config = hills();
  const World here = load_world(config.world);
  const World there = load_world(moved(config, 3000, 2000, true).world);
  double worst_m = 0;
  int compared = 0;
  for (double east_deg = -0.02; east_deg <= 0.05; east_deg += 0.00137) {
    const Geodetic place{(33 + 0.3 * east_deg) * kDegree_rad, (-99.5 + east_deg) * kDegree_rad, 0};
    const auto height_m = [&](const World& world) {
      const WorldPoint p = world.frame.world_from_geodetic(place);
      return world.grid.height_at_m(p.m.x, p.m.z) - world.frame.datum_y_m(p.m.x, p.m.z);
    };
    const double a = height_m(here);
    const double b = height_m(there);
    if (std::isnan(a) || std::isnan(b)) continue;
    worst_m = std::max(worst_m, std::abs(a - b));
    ++compared;
  }
  EXPECT_GT(compared, 20);
  // Two grids of 40 m over hills whose shortest wave is 64 m and 0.6 m high: each is off by parts of that.
  // Hills that moved with the origin would be off by tens of metres.
  EXPECT_LT(worst_m, 2);
}

TEST(FlightWindows, TownsStandWhereTheyStoodWhenTheOriginMoves) {
  const SceneConfig config = hills();
  const World here = load_world(config.world);
  const World there = load_world(moved(config, 3000, 2000, true).world);
  const auto roof_m = [](const World& world, const Building& b) {
    return world.buildings.faces[b.first_face].centre_m;
  };
  int found = 0;
  for (const Building& a : here.buildings.list) {
    const Geodetic on_earth = here.frame.geodetic_from_world({roof_m(here, a)});
    const glm::dvec3 expected_m = there.frame.world_from_geodetic(on_earth).m;
    if (std::hypot(expected_m.x, expected_m.z) > 4000) continue;  // may not have been loaded there
    double nearest_m = 1e9;
    for (const Building& b : there.buildings.list) {
      const glm::dvec3 p = roof_m(there, b);
      nearest_m = std::min(nearest_m, std::hypot(p.x - expected_m.x, p.z - expected_m.z));
    }
    ASSERT_LT(nearest_m, 0.1) << "the neighbours are 220 m away";
    ++found;
  }
  EXPECT_GT(found, 100);
}

}  // namespace
}  // namespace obliq::test
