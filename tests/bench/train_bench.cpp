// What dwells of pulses cost: train_bench SCENE.toml [--set KEY=VALUE] [--dwells N]. An antenna flies and
// scans; each dwell is planned anew and rendered by one thread, as a live radar's is, and rows that
// neighbours share are kept. Prints the processor time of a dwell and its parts. README.md beside this file
// has the case of 64 pulses x 1024 gates, 60 a second.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "server/control/scene_file.h"
#include "server/loading/scene_loading.h"
#include "server/radar/beam/echo_rows.h"
#include "server/radar/pulses/render_train.h"
#include "server/radar/receiver/receiver.h"
#include "terrain/base/stage_clock.h"

namespace obliq {
namespace {

double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double least(std::vector<double> values) { return *std::min_element(values.begin(), values.end()); }
double middle(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void run(const std::string& path, const LoadOptions& load, int dwells) {
  const SceneConfig config = load_scene_file(path, load);
  const auto world = load_world_with_report(config);
  RadarConfig radar = choose_radar(config, "");
  const RadarSettings& s = radar.settings;
  const auto scene = std::make_shared<const Scene>(world, config.materials, 1, config.rays);
  const auto settings = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{s, 1});
  Pose pose = place_radar(*world, radar);
  SharpStore store;
  const double dwell_s = s.scan_dwell_bins * s.sector_deg / s.azimuth_bins / s.scan_rate_deg_s;
  std::vector<double> whole_ms, plan_ms;
  std::size_t bytes = 0;
  int azimuth = 0;
  for (int k = 0; k < dwells; ++k) {
    const double begin_ms = processor_ms();
    const PlanResult planned = plan_frame(scene, settings, pose);
    if (!planned.plan) throw std::runtime_error(planned.errors.front().text());
    plan_ms.push_back(processor_ms() - begin_ms);
    const Receiver receiver(s, radar.name, 1);
    RenderOptions options;
    options.threads = 1;
    options.receiver = &receiver;
    options.sharp = &store;
    options.draw = 1;
    const TrainLook look{{azimuth, std::min(s.scan_dwell_bins, s.azimuth_bins - azimuth)}, s.scan_rate_deg_s};
    const auto made = render_train(scene, *planned.plan, look, options);
    whole_ms.push_back(processor_ms() - begin_ms);
    bytes = made->train.iq.size() * sizeof made->train.iq[0];
    azimuth += s.scan_dwell_bins;
    if (azimuth >= s.azimuth_bins) {
      azimuth = 0;
      store.clear();
      whole_ms.pop_back();  // the next begins without rows
      plan_ms.pop_back();
    }
    pose.antenna.m.x += dwell_s * pose.settings.velocity_east_m_s.value_or(0);
    pose.antenna.m.z += dwell_s * pose.settings.velocity_north_m_s.value_or(0);
  }
  std::printf(
      "%d pulses x %d gates, %.1f dwells/s: %.2f ms of processor time each (least %.2f), of them the plan "
      "%.2f; %.2f MB/s\n",
      s.doppler.pulses, s.range_bins, 1 / dwell_s, middle(whole_ms), least(whole_ms), middle(plan_ms),
      static_cast<double>(bytes) / dwell_s / 1e6);
}

}  // namespace
}  // namespace obliq

int main(int argc, char** argv) {
  std::string scene;
  obliq::LoadOptions load;
  int dwells = 200;
  CLI::App app("Renders dwells of pulses, and prints what they took");
  app.add_option("SCENE", scene, "Scene file")->required();
  app.add_option("--set", load.set, "KEY=VALUE, beats the scene file");
  app.add_option("--dwells", dwells, "How many")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    obliq::run(scene, load, dwells);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "train_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
