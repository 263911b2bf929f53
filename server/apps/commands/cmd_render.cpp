// `obliq render`: one frame of a scene to files, without a server.
#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <set>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/stream_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/frame_report.h"
#include "server/apps/scene_arguments.h"
#include "server/apps/version/version.h"
#include "server/control/sections/targets.h"
#include "server/loading/scene_loading.h"
#include "server/net/requests/request_limits.h"
#include "server/output/describe_frame.h"
#include "server/output/frame_files.h"
#include "server/output/sample_textures.h"
#include "server/radar/frame_plan.h"
#include "server/radar/pulses/render_train.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/render.h"
#include "server/radar/targets/target_echoes.h"
#include "server/scene/scene_memory.h"
#include "server/timing/timing.h"
#include "terrain/base/errors.h"
#include "terrain/base/memory_limit.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

struct RenderArguments {
  SceneArguments scene;
  std::string radar;
  std::string out;
  bool samples = false;
  int video_bits = 0;  ///< 0: no video
  bool labels = false;
  PictureArguments picture;
  bool profile = false;
  int threads = 0;
};

/// Seconds since the last call.
class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = to_seconds(now - last_);
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

std::shared_ptr<const Scene> build(const std::shared_ptr<const World>& world, const SceneConfig& config,
                                   int threads, const RadarConfig& radar) {
  const StageProbe probe(Stage::build);
  auto scene = std::make_shared<const Scene>(world, config.materials, threads, config.rays);
  if (needs_tracer(*scene, radar.settings.frustum)) scene->tracer(terminal_progress());
  return scene;
}

std::string targets_line(const FramePlan& plan, const TargetSet& set) {
  std::set<std::uint64_t> seen;
  const TargetEchoes echoes(plan, air_view(plan.looks_at()), set, {0, plan.settings().azimuth_bins}, {});
  for (const TargetEcho& echo : echoes.echoes()) seen.insert(echo.id);
  return std::to_string(set.targets.size()) + " targets, " + std::to_string(seen.size()) +
         " of them within the ranges and in sight";
}

/// The scene is in memory already.
void check_memory(const SceneConfig& config, const RadarConfig& radar, int threads) {
  net::ServerOptions limits;
  limits.max_memory_mb = memory_limit_mb(config.server.max_memory_mb);
  limits.render_threads = threads;
  const auto over = net::over_memory(radar.settings, net::whole_cost(radar.settings, limits), 0, limits);
  if (over)
    throw InputError("radar \"" + radar.name + "\": server." + over->text +
                     "; allowed: " + over->field.allowed +
                     ", or another limit (--set server.max_memory_mb=MB, inf for none)");
}

void run(const SceneConfig& config, const RenderArguments& arguments) {
  std::map<std::string, double> seconds;
  Stopwatch watch;
  FrameFileOptions files;
  files.picture = picture_options(arguments.picture, true);
  prepare_output_folder(arguments.out);
  RadarConfig radar = choose_radar(config, arguments.radar);
  if (arguments.samples && radar.settings.frustum == FrustumKind::sweep)
    throw InputError(
        "render: --samples: found frustum.kind = \"sweep\", which has no pixels; allowed: "
        "\"symmetric\" or \"oblique\"");
  if (arguments.samples && needs_echo_plan(radar.settings))
    throw InputError(
        "render: --samples: found a beam, a pulse or drawn speckle, whose bins have no pixels of their own; "
        "allowed: beam.pattern = \"off\", pulse.kind = \"off\" and radar.speckle = \"ground\"");
  const int threads = arguments.threads > 0 ? arguments.threads : config.threads;
  StageTimes loading;
  std::optional<StageClock> clock(arguments.profile ? &loading : nullptr);
  const auto world = load_world_with_report(config);
  seconds["load_s"] = watch.lap();
  const auto scene = build(world, config, threads, radar);
  seconds["build_s"] = watch.lap();
  clock.reset();
  if (scene->built_tracer() != nullptr) say_on_terminal(tracer_line(*scene));
  say_on_terminal(scene_memory_line(*scene));

  find_pixels(scene, radar, {config.server.max_pixels, threads}, say_on_terminal, terminal_progress());
  check_memory(config, radar, threads);
  const Pose pose = place_radar(*world, radar);
  const auto snapshot = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{radar.settings, 1});
  watch.lap();
  const PlanResult planned = plan_frame(scene, snapshot, pose);
  if (!planned.plan) throw InputError("radar \"" + radar.name + "\": " + all_text(planned.errors));
  seconds["plan_s"] = watch.lap();

  std::unique_ptr<SampleTextures> textures;
  if (arguments.samples)
    textures = std::make_unique<SampleTextures>(radar.settings.pixel_columns, radar.settings.pixel_rows);
  Frame frame;
  frame.bins = BinBlock(0, radar.settings.azimuth_bins, radar.settings.range_bins);
  FrameSum sum(radar.settings);
  const Progress progress = terminal_progress();
  int done = 0;
  const Receiver receiver(radar.settings, radar.name, radar.settings.receiver.noise_frame,
                          air_view(planned.plan->looks_at()));
  RenderOptions options;
  options.threads = threads;
  options.receiver = &receiver;
  options.observer = textures.get();
  options.video8 = arguments.video_bits == 8;
  options.video16 = arguments.video_bits == 16;
  options.labels = arguments.labels;
  options.draw = frame_draw(radar.name, receiver.counter());
  const TargetsPtr targets = targets_of(config);
  options.targets = targets.get();
  options.on_wedge = [&](Wedge&& wedge) {
    copy_azimuths(wedge.bins, frame.bins);
    sum.add(wedge);
    if (progress)
      progress("rendering", static_cast<double>(++done) / wedge_count(radar.settings.azimuth_bins));
  };
  render_wedges(*planned.plan, {0, radar.settings.azimuth_bins}, options);
  frame.stats = sum.total();
  if (radar.settings.mode == RadarMode::pulses) {
    auto made = render_train(scene, *planned.plan, train_of_frame(radar.settings), options);
    if (made) files.trains.push_back(std::move(made->train));
  }
  seconds["render_s"] = watch.lap();
  if (targets) say_on_terminal(targets_line(*planned.plan, *targets));

  wire::FrameDescriptor descriptor;
  wire::FrameSummary summary;
  describe_frame(*planned.plan, radar.name, config.name, descriptor);
  descriptor.set_build(program_version());
  describe_receiver(receiver, descriptor);
  summarise_frame(*planned.plan, frame.stats, summary);
  files.samples = textures.get();
  if (arguments.picture.ortho) files.ground = &world->grid;
  write_frame_files(arguments.out, descriptor, summary, frame.bins, files);
  seconds["write_s"] = watch.lap();
  if (arguments.profile) {
    Timing timing = time_frames({scene, snapshot, pose, radar.name, config.name, threads});
    timing.scene = time_parts(loading);
    std::fputs(timing_text(timing).c_str(), stderr);
    write_timing(arguments.out, seconds, timing_json(timing));
  } else {
    write_timing(arguments.out, seconds);
  }

  print_frame_report(arguments.out, descriptor, summary,
                     "in " + milliseconds_text(seconds["plan_s"] + seconds["render_s"]),
                     world->report.warnings);
}

}  // namespace

void add_render(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Render one frame of a scene to files, without a server");
  auto arguments = std::make_shared<RenderArguments>();
  add_scene_arguments(*command, "SCENE", arguments->scene);
  add_radar_argument(*command, arguments->radar);
  command->add_option("--out", arguments->out, "Folder for the files (made if missing)")->type_name("DIR");
  command->add_flag("--samples", arguments->samples, "Also write samples.exr, the perspective textures");
  command
      ->add_option("--video-bits", arguments->video_bits,
                   "Also write video.npy, the plane video, of so many bits a bin")
      ->check(CLI::IsMember({8, 16}));
  command->add_flag(
      "--labels", arguments->labels,
      "Also write material.npy, building.npy, height.npy and returns.npy: what the ground of each bin "
      "is");
  add_picture_arguments(*command, arguments->picture);
  command->add_flag("--profile", arguments->profile,
                    "Report where the time of loading and of a frame goes, on stderr and in timing.json; "
                    "renders some extra frames");
  command->add_option("--threads", arguments->threads, "Threads; 0: as in the scene file")
      ->check(whole_number_from(0, 1024));
  command->callback([arguments] {
    auto config = open_scene(arguments->scene);
    if (!config) return;
    if (arguments->out.empty())
      throw InputError("render: --out: found nothing; allowed: a folder for the files");
    say_notes(*config);
    meet_accuracy(*config, say_on_terminal, terminal_progress());
    run(*config, *arguments);
  });
}

}  // namespace obliq
