// What a town costs before its first wedge: seconds and memory to load it, bytes a building, and the wall and
// processor time of a plan, each of its parts the least of a few.
//
//   plan_bench [SCENE]     without: tests/bench/million.toml
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <vector>

#include "server/control/scene_file.h"
#include "server/loading/scene_loading.h"
#include "server/radar/frame_plan.h"
#include "server/scene/scene_memory.h"
#include "tests/support/process_memory.h"

namespace obliq {
namespace {

constexpr int kRepeats = 9;

double wall_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void measure(const char* name, const std::function<void()>& work) {
  double wall = HUGE_VAL, processor = HUGE_VAL;
  for (int k = 0; k < kRepeats; ++k) {
    const double w = wall_s(), p = processor_s();
    work();
    wall = std::min(wall, wall_s() - w);
    processor = std::min(processor, processor_s() - p);
  }
  std::printf("%-32s %8.2f ms wall %8.2f ms of processor time\n", name, 1e3 * wall, 1e3 * processor);
}

void run(const std::string& file) {
  const SceneConfig config = load_scene_file(file);
  const double start = wall_s(), start_processor = processor_s();
  auto world = std::make_shared<World>(load_world(config.world));
  std::printf("loaded in %.2f s (%.2f s of processor time), %.0f MB, at most %.0f MB\n", wall_s() - start,
              processor_s() - start_processor,
              1e-6 * static_cast<double>(test::memory_of(getpid()).resident_bytes),
              1e-6 * static_cast<double>(test::peak_memory_bytes()));
  print_world_report(*world);
  const auto scene = std::make_shared<const Scene>(world, config.materials, 0);
  const SceneMemory memory = scene_memory(*scene);
  const auto n = static_cast<double>(world->buildings.list.size());
  std::printf("scene in %.2f s, %.0f MB, at most %.0f MB; %.0f buildings, %.0f bytes each\n",
              wall_s() - start, 1e-6 * static_cast<double>(test::memory_of(getpid()).resident_bytes),
              1e-6 * static_cast<double>(test::peak_memory_bytes()), n,
              static_cast<double>(memory.buildings) / std::max(1.0, n));
  const RadarConfig& radar = choose_radar(config, "");
  const Pose pose = place_radar(*world, radar);
  const auto settings = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{radar.settings, 1});
  std::shared_ptr<const FramePlan> plan;
  measure("plan", [&] { plan = plan_frame(scene, settings, pose).plan; });
  measure("  heights and roofs of the sector", [&] { measure_sector(*scene, plan->sector()); });
  measure("  seen buildings' flags", [&] { SeenBuildings seen(world->buildings.list.size()); });
  std::size_t entries = 0, in_wedges = 0;
  for (int bin = 0; bin < plan->bins().n_azimuth; ++bin) entries += plan->looks_at().buildings_in(bin).size();
  const int wedges = wedge_count(plan->bins().n_azimuth);
  measure("buildings of all wedges", [&] {
    in_wedges = 0;
    for (int k = 0; k < wedges; ++k)
      in_wedges += plan->looks_at()
                       .buildings_in(AzimuthRange{
                           k * kWedgeAzimuthBins,
                           std::min(kWedgeAzimuthBins, plan->bins().n_azimuth - k * kWedgeAzimuthBins)})
                       .size();
  });
  std::printf("%zu entries in bins, %zu in wedges\n", entries, in_wedges);
  measure("buildings seen, counted", [&] { in_wedges += plan->looks_at().seen().count(); });
}

}  // namespace
}  // namespace obliq

int main(int argc, char** argv) {
  try {
    obliq::run(argc > 1 ? argv[1] : OBLIQ_SOURCE_DIR "/tests/bench/million.toml");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "plan_bench: %s\n", error.what());
    return 1;
  }
}
