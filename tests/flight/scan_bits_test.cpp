// A scanning antenna that flies, over a real scene.
// What stays the same when the loaded window moves, and when the scene's origin does.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <set>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/flight/window.h"
#include "server/radar/receiver/receiver.h"
#include "server/rendering/scene_renderer.h"
#include "terrain/base/units.h"
#include "tests/integration/rendering/render_listener.h"
#include "tests/support/scenes.h"

namespace obliq::test::scan_bits_test {
namespace {

using Time = std::chrono::steady_clock::time_point;
constexpr std::int64_t kStart_ns = 1'000'000'000'000;

/// The ground may return what a sea does.
std::shared_ptr<const Scene> town_in_hills(bool is_sea) {
  std::vector<Material> materials = two_materials();
  if (is_sea) materials[0].model = ScatteringModel::sea;
  WorldSpec spec = synthetic_spec(SyntheticKind::hills, 5000, 40);
  spec.terrain.shape.height_m = 300;
  PrismSpec prisms;
  prisms.per_km2 = 30;
  spec.prisms = {prisms};
  return make_scene(load_world(spec), materials);
}

struct Case {
  FrustumKind kind;
  bool moves = true;
  bool is_radar = false;  ///< a beam, a pulse, noise
  bool is_sea = false;    ///< whose texture drifts with the sim time
};

void expect_bits_of_whole_frames(const Case& tested) {
  const FrustumKind kind = tested.kind;
  const auto scene = town_in_hills(tested.is_sea);
  scene->tracer();  // so that the first dwell is not missed for it
  const ScanWatch<rendering::SceneRenderer> renderer(scene, "town");
  RadarSettings settings;
  settings.frustum = kind;
  settings.sector_deg = 90;
  settings.r_min_m = 1000;
  settings.r_max_m = 4000;
  settings.pixel_columns = settings.pixel_rows = 128;
  settings.azimuth_bins = 60;  // the last dwell is a short one
  settings.range_bins = 64;
  settings.scan_mode = ScanMode::sector;
  settings.scan_rate_deg_s = 90;
  settings.scan_dwell_bins = 16;

  if (tested.is_radar) {
    settings.beam.pattern = BeamPattern::gaussian;
    settings.beam.width_deg = 4;
    settings.pulse.kind = PulseKind::compressed;
    settings.receiver.noise = true;
    settings.power_w = 1e3;
  }

  if (tested.is_sea) {
    settings.sea.state = 3;
    settings.sea.shape = 0.5;
    settings.atmosphere.wind_m_s = 30;
  }

  PoseSettings pose;
  pose.latitude_deg = 33;
  pose.longitude_deg = -99.5;
  pose.height_m = 900;
  const auto poses = std::make_shared<PoseTimeLine>(pose);
  for (int i = 0; i < 6; ++i) {  // 111 m/s north, turning
    pose.latitude_deg = 33 + (tested.moves ? 0.00025 * i : 0);
    pose.bearing_deg = 350 + (tested.moves ? 7.0 * i : 0);
    pose.sim_time_ns = i * 250'000'000LL;
    ASSERT_TRUE(poses->add(pose, kStart_ns));
  }
  std::atomic<std::int64_t> now_ns = kStart_ns;
  rendering::RenderThreadOptions options;
  options.clock = [&] { return Time(std::chrono::nanoseconds(now_ns.load())); };
  Listener events;
  rendering::RenderThread thread(renderer, events, options);
  thread.add_radar("main", 1, {snapshot(settings), {}, 0, poses});
  rendering::Demand demand;
  demand.watch_id = 1;
  demand.rate_hz = 1;
  demand.choice.planes = wire::plane_bit(wire::Plane::iq);
  thread.set_demand(0, {demand});
  thread.start();
  while (!renderer.scan_has_begun) std::this_thread::yield();
  for (double s = 0.05; s < 1; s += 0.05) {
    now_ns = kStart_ns + static_cast<std::int64_t>(s * 1e9);
    thread.wake();
    std::size_t due = 0;  // each of the four dwells has two wedges
    for (const double middle_bin : {8.0, 24.0, 40.0, 54.0}) due += middle_bin / 60 <= s ? 2 : 0;
    ASSERT_TRUE(events.wait([&] { return events.wedges.size() >= due; }));
  }
  ASSERT_TRUE(events.wait([&] { return !events.ends.empty(); }));
  thread.end();

  std::set<double> bearings;
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < events.wedges.size(); ++i) {
    const wire::WedgeBlock& wedge = events.wedges[i];
    PoseSettings its_pose;
    ASSERT_TRUE(merge_message(wedge.pose(), its_pose).empty());
    bearings.insert(its_pose.bearing_deg);
    std::vector<FieldError> errors;
    const auto placed = place_antenna(scene->world(), its_pose, errors);
    ASSERT_TRUE(placed);
    const std::uint64_t counter = events.begins.at(0).frame().noise_counter();
    const Receiver receiver(settings, "main", counter);
    RenderOptions as_sent;
    as_sent.draw = frame_draw("main", counter);
    as_sent.receiver = &receiver;
    const Frame whole = render(scene, snapshot(settings), *placed, {0, settings.azimuth_bins}, as_sent);
    const std::size_t row_bytes = static_cast<std::size_t>(settings.range_bins) * 8;
    ASSERT_EQ(events.values[i].size(), wedge.n_azimuth() * row_bytes);
    const auto* expected = reinterpret_cast<const std::byte*>(whole.bins.iq.data());
    EXPECT_EQ(std::memcmp(events.values[i].data(), expected + wedge.first_azimuth() * row_bytes,
                          events.values[i].size()),
              0)
        << "wedge at azimuth bin " << wedge.first_azimuth();
    bytes += events.values[i].size();
  }
  EXPECT_GE(bearings.size(), tested.moves ? 3u : 1u) << "the dwells had poses of their own";
  EXPECT_GT(bytes, 0u);
}

TEST(ScanBits, EachDwellOfTheSweepIsThatOfAWholeFrameAtItsPose) {
  expect_bits_of_whole_frames({FrustumKind::sweep});
}

TEST(ScanBits, EachDwellOfTheObliqueFrustumIsThatOfAWholeFrameAtItsPose) {
  expect_bits_of_whole_frames({FrustumKind::oblique});
}

// A radar that moves shares sharp bins between neighbouring dwells: its dwells are not those of whole frames.
TEST(ScanBits, ThroughARadarTheDwellsOfAnAntennaThatStandsAreAWholeFrame) {
  expect_bits_of_whole_frames({FrustumKind::sweep, false, true});
  expect_bits_of_whole_frames({FrustumKind::oblique, false, true});
}

TEST(ScanBits, TheSeaOfEachDwellIsThatOfAWholeFrameAtItsSimTime) {
  expect_bits_of_whole_frames({.kind = FrustumKind::sweep, .is_sea = true});
  expect_bits_of_whole_frames({.kind = FrustumKind::sweep, .moves = false, .is_sea = true});
}

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

Frame frame_at(const std::shared_ptr<const Scene>& scene, const PoseSettings& pose, FrustumKind kind,
               int sub_columns = RadarSettings{}.sub_columns) {
  RadarSettings settings = radar_settings(kind, {1000, 3000}, {64, 64}, {128, 128});
  settings.sub_columns = sub_columns;
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
  const Frame a = frame_at(before, pose, FrustumKind::sweep, 0);
  const Frame b = frame_at(after, pose, FrustumKind::sweep, 0);
  EXPECT_GT(a.stats.samples, 1000u);
  EXPECT_EQ(std::memcmp(a.bins.iq.data(), b.bins.iq.data(), a.bins.iq.size() * sizeof a.bins.iq[0]), 0);
  EXPECT_EQ(a.bins.state, b.bins.state);
  // The floats of sub-columns count from the grid's edge, which moves.
  const Frame c = frame_at(before, pose, FrustumKind::sweep);
  const Frame d = frame_at(after, pose, FrustumKind::sweep);
  double most_w = 0, worst_w = 0;
  int n = 0;
  for (std::size_t k = 0; k < c.bins.power_w.size(); ++k) {
    most_w = std::max(most_w, c.bins.power_w[k]);
    worst_w = std::max(worst_w, std::abs(c.bins.power_w[k] - d.bins.power_w[k]));
    if (c.bins.power_w[k] != d.bins.power_w[k]) ++n;
  }
  std::printf("    %d bins differ, at most by %g of the brightest\n", n, worst_w / most_w);
  EXPECT_LT(worst_w, 1e-6 * most_w);
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
    return world.buildings.face(b.first_face).centre_m;
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
}  // namespace obliq::test::scan_bits_test
