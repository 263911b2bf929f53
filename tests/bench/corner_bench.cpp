// What corners of walls and ground cost: corner_bench [SCENE.toml] [--set KEY=VALUE] renders a scene without
// and with them in turn, and prints the processor time of a frame on one thread: the least of some turns, and
// the middle of what a turn with them costs beyond the one before it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "server/control/scene_file.h"
#include "server/loading/scene_loading.h"
#include "server/radar/render.h"

namespace obliq {
namespace {

constexpr int kTurns = 41;

void run(const std::string& scene_file, const LoadOptions& options) {
  const SceneConfig config = load_scene_file(scene_file, options);
  const RadarConfig& radar = config.radars.front();
  const auto settings = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{radar.settings, 1});
  const auto loaded = load_world_with_report(config);
  std::vector<std::shared_ptr<const FramePlan>> plans;
  for (const bool corners : {false, true}) {
    World world = *loaded;
    world.buildings.corners = corners;
    const auto scene = std::make_shared<const Scene>(std::make_shared<const World>(std::move(world)),
                                                     config.materials, 1, config.rays);
    const PlanResult planned = plan_frame(scene, settings, place_radar(scene->world(), radar));
    if (!planned.plan) throw InputError(all_text(planned.errors));
    plans.push_back(planned.plan);
  }
  double least_ms[] = {HUGE_VAL, HUGE_VAL};
  double last_ms = 0;
  std::vector<double> ratios;
  double sum_w[] = {0, 0};
  for (int turn = 0; turn < 2 * kTurns; ++turn) {
    RenderOptions frame;
    frame.threads = 1;
    double& sum = sum_w[turn % 2] = 0;
    frame.on_wedge = [&](Wedge&& wedge) {
      for (const double power_w : wedge.bins.power_w) sum += power_w;
    };
    const std::clock_t start = std::clock();
    render_wedges(*plans[static_cast<std::size_t>(turn % 2)], {0, radar.settings.azimuth_bins}, frame);
    const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    least_ms[turn % 2] = std::min(least_ms[turn % 2], ms);
    if (turn % 2 == 1) ratios.push_back(ms / last_ms);
    last_ms = ms;
  }
  std::ranges::sort(ratios);
  std::printf(
      "frame of %d x %d bins, %zu buildings, one thread: %.1f ms, with corners %.1f ms: %+.1f %%; %+.2f dB "
      "of power\n",
      radar.settings.azimuth_bins, radar.settings.range_bins, loaded->buildings.list.size(), least_ms[0],
      least_ms[1], 100 * (ratios[ratios.size() / 2] - 1), 10 * std::log10(sum_w[1] / sum_w[0]));
}

}  // namespace
}  // namespace obliq

int main(int argc, char** argv) {
  CLI::App app("What corners of walls and ground cost");
  std::string scene = std::string(OBLIQ_SOURCE_DIR) + "/tests/bench/city.toml";
  obliq::LoadOptions options;
  app.add_option("scene", scene, "Scene file");
  app.add_option("--set", options.set, "KEY=VALUE");
  CLI11_PARSE(app, argc, argv);
  try {
    obliq::run(scene, options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "corner_bench: %s\n", error.what());
    return 1;
  }
}
