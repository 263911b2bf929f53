// Frames on demand: frame_turns SCENE.toml [--set KEY=VALUE] [--threads N] [--bare] [--labels] loads a scene,
// renders a frame that is not measured, then one for each line that it reads, of a radar that moves on from
// frame to frame, and prints what the frame took, plan included. So several of these, of several builds, run
// in turn on a machine that is not quiet: cities.py. It compiles against commit ed06c75 as well, with which
// cities.py compares: hence the two places of some headers.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "server/control/scene_file.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#if __has_include("server/loading/scene_loading.h")
#include "server/loading/scene_loading.h"
#else
#include "server/apps/scene_loading.h"
#endif

namespace obliq {
namespace {

constexpr double kStep_m = 2;  // of the radar from frame to frame: 200 m/s and 100 frames a second

struct Arguments {
  std::string scene;
  LoadOptions options;
  int threads = 2;
  bool bare = false;
  bool labels = false;
};

/// Leaves out what nobody asks for, where the build can.
template <class Options>
void ask_for_power_and_state_alone(Options& options) {
  if constexpr (requires { options.iq; }) options.iq = false;
}

template <class Options>
void ask_for_labels(Options& options) {
  if constexpr (requires { options.labels; }) options.labels = true;
}

double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class Turns {
 public:
  explicit Turns(const Arguments& arguments)
      : arguments_(arguments), config_(load_scene_file(arguments.scene, arguments.options)) {
    const auto start = std::chrono::steady_clock::now();
    const auto world = load_world_with_report(config_);
    radar_ = choose_radar(config_, "");
    scene_ = std::make_shared<const Scene>(world, config_.materials, arguments.threads, config_.rays);
    load_s_ = seconds_since(start);
    pose_ = place_radar(*world, radar_);
    settings_ = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{radar_.settings, 1});
  }

  nlohmann::json frame() {
    const RadarSettings& s = radar_.settings;
    double power_w = 0;
    RenderOptions options;
    options.threads = arguments_.threads;
    if (arguments_.bare) ask_for_power_and_state_alone(options);
    if (arguments_.labels) ask_for_labels(options);
    FrameSum sum(s);
    options.on_wedge = [&](Wedge&& wedge) {
      sum.add(wedge);
      for (const double w : wedge.bins.power_w) power_w += w;
    };
    const double processor_start_s = processor_s();
    const auto start = std::chrono::steady_clock::now();
    const PlanResult planned = plan_frame(scene_, settings_, pose_);
    if (!planned.plan) throw std::runtime_error("the frame cannot be planned");
    const double plan_s = seconds_since(start);
    render_wedges(*planned.plan, {0, s.azimuth_bins}, options);
    const double wall_s = seconds_since(start), processor = processor_s() - processor_start_s;
    pose_.antenna.m.x += kStep_m * std::sin(pose_.bearing_world_rad);
    pose_.antenna.m.z += kStep_m * std::cos(pose_.bearing_world_rad);
    return {{"processor_s", processor},
            {"wall_s", wall_s},
            {"plan_s", plan_s},
            {"load_s", load_s_},
            {"power_w", power_w},
            {"samples", sum.total().samples},
            {"buildings", scene_->world().buildings.list.size()},
            {"seen", planned.plan->looks_at().seen().count()}};
  }

 private:
  const Arguments& arguments_;
  SceneConfig config_;
  RadarConfig radar_;
  std::shared_ptr<const Scene> scene_;
  SettingsPtr settings_;
  Pose pose_;
  double load_s_ = 0;
};

}  // namespace
}  // namespace obliq

int main(int argc, char** argv) {
  obliq::Arguments arguments;
  CLI::App app("Renders a frame for each line that it reads, and prints what it took");
  app.add_option("SCENE", arguments.scene, "Scene file")->required();
  app.add_option("--set", arguments.options.set, "KEY=VALUE, beats the scene file");
  app.add_option("--threads", arguments.threads, "Of a frame")->check(CLI::PositiveNumber);
  app.add_flag("--bare", arguments.bare, "Power and state alone, where the build can leave I&Q out");
  app.add_flag("--labels", arguments.labels, "And labels, where the build has them");
  CLI11_PARSE(app, argc, argv);
  try {
    obliq::Turns turns(arguments);
    turns.frame();  // caches, page tables, Embree's tree
    std::cout << "ready" << std::endl;
    for (std::string line; std::getline(std::cin, line);) std::cout << turns.frame().dump() << std::endl;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "frame_turns: %s\n", error.what());
    return 1;
  }
  return 0;
}
