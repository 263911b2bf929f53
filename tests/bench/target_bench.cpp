// What targets cost: target_bench [SCENE.toml] [--set KEY=VALUE] puts 100 and 10,000 of them
// onto the ground of a scene, and prints the time on one thread of their places and lines of sight, of their
// echoes in the frame's bins, and of the frame itself, each the least of some turns.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "server/control/scene_file.h"
#include "server/loading/scene_loading.h"
#include "server/radar/render.h"
#include "server/radar/targets/target_echoes.h"
#include "terrain/base/hash.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr int kTurns = 15;

/// Spread evenly over the sector's azimuths and ranges.
TargetSet targets_in(const FramePlan& plan, int n) {
  const auto uniform = [](std::uint64_t key) { return static_cast<double>(mix64(key) >> 11) * 0x1p-53; };
  const WorldFrame& frame = plan.scene().world().frame;
  const Sector& sector = plan.sector();
  TargetSet set;
  for (std::uint64_t k = 1; k <= static_cast<std::uint64_t>(n); ++k) {
    const double bearing = sector.bearing_rad + (uniform(2 * k) - 0.5) * sector.width_rad;
    const double d_m = sector.r_min_m + uniform(2 * k + 1) * (sector.r_max_m - sector.r_min_m);
    const Geodetic at = frame.geodetic_from_world(
        {{sector.antenna_m.x + d_m * std::sin(bearing), 0, sector.antenna_m.z + d_m * std::cos(bearing)}});
    Target target;
    target.id = k;
    target.latitude_deg = at.latitude_rad / kDegree_rad;
    target.longitude_deg = at.longitude_rad / kDegree_rad;
    target.size.top_m = 3;
    set.targets.push_back(target);
  }
  return set;
}

/// The least of several turns, ms.
template <class Work>
double least_ms(const Work& work) {
  double least = HUGE_VAL;
  for (int turn = 0; turn < kTurns; ++turn) {
    const auto start = std::chrono::steady_clock::now();
    work();
    least = std::min(least, 1e3 * seconds_since(start));
  }
  return least;
}

void run(const std::string& scene_file, const LoadOptions& options) {
  const SceneConfig config = load_scene_file(scene_file, options);
  const auto world = load_world_with_report(config);
  const RadarConfig radar = choose_radar(config, "");
  const auto scene = std::make_shared<const Scene>(world, config.materials, 1, config.rays);
  const auto settings = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{radar.settings, 1});
  const PlanResult planned = plan_frame(scene, settings, place_radar(*world, radar));
  if (!planned.plan) throw InputError(all_text(planned.errors));
  const FramePlan& plan = *planned.plan;
  const AirView air = air_view(plan.looks_at());
  std::vector<BinBlock> wedges;
  RenderOptions frame;
  frame.threads = 1;
  frame.on_wedge = [&](Wedge&& wedge) { wedges.push_back(std::move(wedge.bins)); };
  const AzimuthRange all{0, radar.settings.azimuth_bins};
  const double bare_ms = least_ms([&] {
    wedges.clear();
    render_wedges(plan, all, frame);
  });
  std::printf("frame of %d x %d bins, one thread: %.1f ms\n", radar.settings.azimuth_bins,
              radar.settings.range_bins, bare_ms);
  scene->bounds();
  for (const int n : {100, 10000}) {
    const TargetSet set = targets_in(plan, n);
    std::optional<TargetEchoes> echoes;
    const double see_ms =
        least_ms([&] { echoes.emplace(plan, air, set, all, TargetLook{.at = {}, .frame = 1}); });
    const double add_ms = least_ms([&] {
      for (BinBlock& bins : wedges) echoes->add(bins, true);
    });
    std::printf(
        "%5d targets, %zu in sight: places and sights %.2f ms, echoes %.2f ms, of the frame %.1f %%\n", n,
        echoes->echoes().size(), see_ms, add_ms, 100 * (see_ms + add_ms) / bare_ms);
  }
}

}  // namespace
}  // namespace obliq

int main(int argc, char** argv) {
  std::string scene = OBLIQ_SOURCE_DIR "/tests/bench/paper_hills.toml";
  obliq::LoadOptions options;
  options.set = {"beam.pattern=gaussian", "beam.width_deg=3", "pulse.kind=compressed"};
  CLI::App app("What targets cost in a frame");
  app.add_option("SCENE", scene, "Scene file");
  app.add_option("--set", options.set, "KEY=VALUE, beats the scene file");
  CLI11_PARSE(app, argc, argv);
  try {
    obliq::run(scene, options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "target_bench: %s\n", error.what());
    return 1;
  }
}
