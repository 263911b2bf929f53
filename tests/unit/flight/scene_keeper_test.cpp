// The keeper with a stand-in for loading: what it builds, when, and what it does when that fails.
#include "server/flight/scene_keeper.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <future>

#include "server/control/scene_file.h"
#include "terrain/base/errors.h"
#include "tests/support/scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq::test::scene_keeper_test {
namespace {

constexpr double kRMax_m = 20000;

SceneConfig flat_config() {
  SceneConfig config;
  config.name = "flat";
  config.world.terrain.synthetic = SyntheticKind::flat;
  config.materials = two_materials();
  config.radars.emplace_back();
  config.radars[0].settings.r_max_m = kRMax_m;
  config.radars[0].pose.latitude_deg = 33;
  config.radars[0].pose.longitude_deg = -99;
  set_terrain_reach(config);
  return config;
}

std::vector<RadarPlace> at(double east_km, double r_max_m = kRMax_m) {
  // 111.2 km to a degree of a great circle of the mean sphere.
  return {{{-99 + east_km / (111.195 * std::cos(33 * std::acos(-1) / 180)), 33}, r_max_m}};
}

std::shared_ptr<const Scene> tiny_scene() {
  WorldSpec spec = synthetic_spec(SyntheticKind::flat, 100, 50);
  return make_scene(load_world(spec));
}

/// Builds tiny scenes and remembers what for; stops at a gate, fails on request.
class Yard {
 public:
  SceneKeeper::Build build() {
    return [this](const SceneConfig& config, const std::stop_token&) -> std::shared_ptr<const Scene> {
      std::unique_lock lock(mutex_);
      built_.push_back(config);
      changed_.notify_all();
      changed_.wait(lock, [this] { return open_; });
      if (!failure_.empty()) throw InputError(failure_);
      return tiny_scene();
    };
  }
  SceneKeeper::Swap swap() {
    return [this](std::shared_ptr<const Scene> scene) {
      const std::lock_guard lock(mutex_);
      serving_ = std::move(scene);
      ++swaps_;
      changed_.notify_all();
    };
  }
  void fail_with(const std::string& failure) {
    const std::lock_guard lock(mutex_);
    failure_ = failure;
  }
  void open(bool open) {
    const std::lock_guard lock(mutex_);
    open_ = open;
    changed_.notify_all();
  }
  std::vector<SceneConfig> wait_built(std::size_t n) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(60), [&] { return built_.size() >= n; });
    return built_;
  }
  int wait_swaps(int n) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(60), [&] { return swaps_ >= n; });
    return swaps_;
  }
  std::shared_ptr<const Scene> serving() {
    const std::lock_guard lock(mutex_);
    return serving_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<SceneConfig> built_;
  std::string failure_;
  bool open_ = true;
  int swaps_ = 0;
  std::shared_ptr<const Scene> serving_;
};

/// The outcome of a reload, waited for.
struct Answer {
  std::promise<std::string> promise;
  SceneKeeper::Done done() {
    return [this](const std::string& error) { promise.set_value(error); };
  }
  std::string wait() {
    auto future = promise.get_future();
    if (future.wait_for(std::chrono::seconds(60)) != std::future_status::ready) return "no answer";
    return future.get();
  }
};

TEST(SceneKeeper, AFlightOutOfTheLoadedAreaGetsTheNextWindowAroundIt) {
  Yard yard;
  SceneKeeper keeper(flat_config(), tiny_scene(), yard.build(), yard.swap());
  keeper.poses_changed(at(0));
  keeper.poses_changed(at(2));  // the margin is 5 km
  keeper.poses_changed(at(4));
  ASSERT_EQ(yard.wait_swaps(1), 1);
  const std::vector<SceneConfig> built = yard.wait_built(1);
  ASSERT_EQ(built.size(), 1u);
  ASSERT_EQ(built[0].world.reaches.size(), 1u);
  EXPECT_NEAR(built[0].world.reaches[0].centre.longitude_deg, at(4)[0].position.longitude_deg, 1e-9);
  EXPECT_NEAR(built[0].world.reaches[0].radius_m, 25000, 1e-6);
  EXPECT_EQ(built[0].world.origin.longitude_deg, -99) << "the grid's posts stay where they are";
  ASSERT_TRUE(built[0].world.terrain.shape.anchor.has_value());
  EXPECT_EQ(built[0].world.terrain.shape.anchor->longitude_deg, -99);
  EXPECT_EQ(built[0].world.terrain.cell_m, 50) << "what \"auto\" gave the first scene";
}

/// The time of a test: the keeper's clock.
struct TestClock {
  std::atomic<std::int64_t> ms = 1'000'000;
  SceneKeeper::Now now() {
    return [this] { return SceneKeeper::Clock::time_point(std::chrono::milliseconds(ms)); };
  }
};

/// What has been built when nothing more comes. A keeper that loads without end loads hundreds of these
/// scenes meanwhile.
std::size_t built_in_the_end(Yard& yard) {
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  return yard.wait_built(0).size();
}

/// Two jumps, a second apart; then nothing more arrives.
void expect_one_window_a_jump(const SceneConfig& config, double jump_km) {
  const LonLat start = config.world.origin;
  Yard yard;
  TestClock clock;
  SceneKeeper keeper(config, tiny_scene(), yard.build(), yard.swap(), clock.now());
  for (int k = 0; k < 3; ++k) {
    keeper.poses_changed({{{start.longitude_deg, start.latitude_deg + jump_km / 111.195 * k},
                           config.radars[0].settings.r_max_m}});
    if (k > 0) {
      EXPECT_EQ(yard.wait_swaps(k), k);
    }
    EXPECT_EQ(built_in_the_end(yard), k) << "after jump " << k;
    clock.ms += 1000;
  }
  for (const int later_ms : {1500, 5000, 60000}) {
    clock.ms += later_ms;
    EXPECT_EQ(built_in_the_end(yard), 2u);
  }
}

TEST(SceneKeeper, AJumpLoadsOneWindowAndNoMore) {
  expect_one_window_a_jump(flat_config(), 6);
  expect_one_window_a_jump(flat_config(), 80);
}

TEST(SceneKeeper, AJumpInTheQuickStartsHillsLoadsOneWindowAndNoMore) {
  expect_one_window_a_jump(
      load_scene_file(OBLIQ_SOURCE_DIR "/deploy/scenes/demo_hills.toml", {{"frustum.kind=sweep"}}), 8);
}

TEST(SceneKeeper, AFastFlightAtShortRangeLoadsAWindowForEveryHalfMargin) {
  constexpr double kShort_m = 4000;  // margin 1 km
  SceneConfig config = flat_config();
  config.radars[0].settings.r_max_m = kShort_m;
  set_terrain_reach(config);
  Yard yard;
  TestClock clock;
  SceneKeeper keeper(config, tiny_scene(), yard.build(), yard.swap(), clock.now());
  for (int i = 0; i <= 140; ++i) {  // 250 m/s for 14 s, told of at 10 Hz
    keeper.poses_changed(at(0.025 * i, kShort_m));
    clock.ms += 100;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // what is due is built at once
  }
  EXPECT_GE(yard.wait_swaps(1), 1);
  EXPECT_LE(built_in_the_end(yard), 8u) << "3.5 km, half a kilometre each, and one for the start";
}

TEST(SceneKeeper, ASceneThatCannotBeLoadedLeavesTheOldOneAndIsNotTriedAgainAtOnce) {
  Yard yard;
  yard.fail_with("no ground there");
  SceneKeeper keeper(flat_config(), tiny_scene(), yard.build(), yard.swap());
  keeper.poses_changed(at(4));
  ASSERT_EQ(yard.wait_built(1).size(), 1u);
  while (keeper.state().failures == 0) std::this_thread::yield();
  for (int i = 0; i < 1000; ++i) keeper.poses_changed(at(4 + 0.001 * i));
  EXPECT_EQ(yard.serving(), nullptr);
  EXPECT_EQ(keeper.state().last_error, "no ground there");
  EXPECT_EQ(yard.wait_built(1).size(), 1u);

  Answer answer;  // a reload is tried whatever failed before
  keeper.reload(flat_config(), answer.done());
  EXPECT_EQ(answer.wait(), "no ground there");
  yard.fail_with("");
  Answer second;
  keeper.reload(flat_config(), second.done());
  EXPECT_EQ(second.wait(), "");
  EXPECT_NE(yard.serving(), nullptr);
  EXPECT_EQ(keeper.state().swaps, 1u);
}

TEST(SceneKeeper, AFailureThatIsOverDoesNotLookPresent) {
  Yard yard;
  yard.fail_with("no ground there");
  TestClock clock;
  SceneKeeper keeper(flat_config(), tiny_scene(), yard.build(), yard.swap(), clock.now());
  keeper.poses_changed(at(4));
  while (keeper.state().failures == 0) std::this_thread::yield();
  EXPECT_EQ(keeper.state().last_error, "no ground there");
  EXPECT_EQ(keeper.state().well_s, 0);
  clock.ms += 3000;
  keeper.poses_changed(at(0));  // back where there is ground
  clock.ms += 7000;
  const SceneKeeper::State after = keeper.state();
  EXPECT_EQ(after.last_error, "");
  EXPECT_EQ(after.last_failure, "no ground there");
  EXPECT_EQ(after.well_s, 7);
}

TEST(SceneKeeper, WhereNoFileHasGroundNothingIsTriedAndOtherRadarsDoNotSuffer) {
  const Folder folder;
  RasterPlan degree;
  degree.columns = degree.rows = 10;
  degree.geotransform = {-99.5, 0.1, 0, 33.5, 0, -0.1};
  degree.value = [](double, double) { return 100.0; };
  SceneConfig config = flat_config();
  config.world.terrain.synthetic = SyntheticKind::none;
  config.world.terrain.dem = {write_raster(folder, "degree.tif", degree)};
  Yard yard;
  SceneKeeper keeper(config, tiny_scene(), yard.build(), yard.swap());
  EXPECT_EQ(keeper.ground_at({-99, 33}, 20000).warning, "");
  EXPECT_EQ(keeper.ground_at({-99, 33}, 20000).coverage, 1);
  const GroundThere far = keeper.ground_at({-118, 34}, 20000);
  EXPECT_EQ(far.coverage, 0);
  EXPECT_NE(
      far.warning.find("terrain.dem covers longitude -99.5000 to -98.5000, latitude 32.5000 to 33.5000"),
      std::string::npos)
      << far.warning;
  keeper.poses_changed(at(1458));
  EXPECT_EQ(built_in_the_end(yard), 0u);
  EXPECT_EQ(keeper.state().last_error, "");
  keeper.poses_changed({at(1458)[0], at(4)[0]});
  ASSERT_EQ(yard.wait_swaps(1), 1);
  EXPECT_EQ(yard.wait_built(1)[0].world.reaches.size(), 1u) << "of the one that sees ground";
  EXPECT_EQ(keeper.state().failures, 0u);
}

TEST(SceneKeeper, OfSeveralReloadsTheNewestWinsAndEachIsAnswered) {
  Yard yard;
  yard.open(false);
  SceneKeeper keeper(flat_config(), tiny_scene(), yard.build(), yard.swap());
  Answer first, second, third;
  keeper.reload(flat_config(), first.done());
  ASSERT_EQ(yard.wait_built(1).size(), 1u);
  SceneConfig other = flat_config();
  other.name = "second";
  keeper.reload(other, second.done());
  other.name = "third";
  keeper.reload(other, third.done());
  EXPECT_NE(second.wait(), "");
  yard.open(true);
  EXPECT_NE(first.wait(), "") << "what is built for an older one is dropped";
  EXPECT_EQ(third.wait(), "");
  EXPECT_EQ(keeper.state().swaps, 1u);
  EXPECT_EQ(keeper.state().failures, 0u);
  const auto built = yard.wait_built(2);
  ASSERT_EQ(built.size(), 2u);
  EXPECT_EQ(built[1].name, "third");
}

TEST(SceneKeeper, AReloadIsAimedAtWhereTheRadarsAreNow) {
  Yard yard;
  SceneKeeper keeper(flat_config(), tiny_scene(), yard.build(), yard.swap());
  keeper.poses_changed(at(30));
  ASSERT_EQ(yard.wait_swaps(1), 1);
  Answer answer;
  keeper.reload(flat_config(), answer.done());
  EXPECT_EQ(answer.wait(), "");
  EXPECT_NEAR(yard.wait_built(2)[1].world.origin.longitude_deg, at(30)[0].position.longitude_deg, 1e-9);
}

TEST(SceneKeeper, TheNextSceneIsBegunWhenTheOneBeforeTheLastHasGone) {
  Yard yard;
  SceneKeeper keeper(flat_config(), tiny_scene(), yard.build(), yard.swap());
  Answer first, second, third;
  keeper.reload(flat_config(), first.done());
  ASSERT_EQ(first.wait(), "");
  std::shared_ptr<const Scene> frame = yard.serving();  // the current frame holds its scene
  const std::weak_ptr<const Scene> watched = frame;
  keeper.reload(flat_config(), second.done());
  ASSERT_EQ(second.wait(), "");
  keeper.reload(flat_config(), third.done());
  while (!keeper.state().building) std::this_thread::yield();
  EXPECT_EQ(yard.wait_built(2).size(), 2u) << "a third scene would be in memory";
  frame.reset();
  EXPECT_EQ(third.wait(), "");
  EXPECT_TRUE(watched.expired());
}

TEST(SceneKeeper, StoppingAnswersWhatWaits) {
  Yard yard;
  yard.open(false);
  Answer first, second;
  auto keeper = std::make_unique<SceneKeeper>(flat_config(), tiny_scene(), yard.build(), yard.swap());
  keeper->reload(flat_config(), first.done());
  ASSERT_EQ(yard.wait_built(1).size(), 1u);
  keeper->reload(flat_config(), second.done());
  std::thread opener([&] { yard.open(true); });
  keeper.reset();
  opener.join();
  EXPECT_NE(first.wait(), "") << "a newer one had come";
  EXPECT_EQ(second.wait(), "the server is stopping");
}

}  // namespace
}  // namespace obliq::test::scene_keeper_test
