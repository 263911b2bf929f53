// How soon a client on the loopback has something to show: its first wedge, and the last byte of the frame
// after its last wedge has been binned, both as shares of the frame's time (from the begin of its plan to its
// last byte at the client). And how many frames of a radar that stands still a client gets, which are not
// rendered anew. A server with the real renderer, and a client that checks every message.
//   first_light SCENE.toml [--set KEY=VALUE] [--frames N] [--json FILE]
#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "client/client.h"
#include "proto/obliq.pb.h"
#include "server/control/scene_file.h"
#include "server/loading/scene_loading.h"
#include "server/output/frame_files.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/rendering/frame_cache.h"
#include "server/rendering/scene_renderer.h"
#include "tests/bench/numbers.h"
#include "tests/bench/stream/served.h"

namespace {

using namespace obliq;
using Clock = std::chrono::steady_clock;
constexpr client::Timeout kLong{120000};

constexpr double kFirstTarget = 0.15;
constexpr double kLastTarget = 0.10;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

/// When the current frame began and when its last wedge was binned. One frame is rendered at a time.
struct Moments {
  std::atomic<Clock::time_point> begin;
  std::atomic<Clock::time_point> first_binned;
  std::atomic<Clock::time_point> last_binned;
};

class WatchedFrame : public rendering::PlannedFrame {
 public:
  WatchedFrame(std::unique_ptr<rendering::PlannedFrame> frame, Moments& moments)
      : frame_(std::move(frame)), moments_(moments) {}
  void describe(const std::string& radar, wire::FrameDescriptor& descriptor) const override {
    frame_->describe(radar, descriptor);
  }
  bool render(AzimuthRange azimuths, const RenderOptions& options) const override {
    RenderOptions watched = options;
    bool first = true;
    watched.on_wedge = [&](Wedge&& wedge) {
      moments_.last_binned = Clock::now();
      if (std::exchange(first, false)) moments_.first_binned = Clock::now();
      options.on_wedge(std::move(wedge));
    };
    return frame_->render(azimuths, watched);
  }
  void summarise(const FrameStats& stats, wire::FrameSummary& summary) const override {
    frame_->summarise(stats, summary);
  }

 private:
  std::unique_ptr<rendering::PlannedFrame> frame_;
  Moments& moments_;
};

class WatchedRenderer : public rendering::FrameRenderer {
 public:
  WatchedRenderer(std::shared_ptr<const Scene> scene, Moments& moments)
      : renderer_(std::move(scene), "hills"), moments_(moments) {}
  std::vector<FieldError> place(const PoseSettings& pose) const override { return renderer_.place(pose); }
  Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const override {
    moments_.begin = Clock::now();
    Plan plan = renderer_.plan(settings, pose);
    if (plan.frame) plan.frame = std::make_unique<WatchedFrame>(std::move(plan.frame), moments_);
    return plan;
  }

 private:
  rendering::SceneRenderer renderer_;
  Moments& moments_;
};

void check(const client::Status& status) {
  if (status.ok()) return;
  throw std::runtime_error(status.sentence());
}

/// What the client sees of the current frame.
struct Watcher : client::FrameHandler {
  bool begun = false;
  std::uint32_t first_index = 0;
  Clock::time_point first_wedge;  ///< its last plane
  bool ended = false;

  client::Status on_begin(const wire::MessageHeader&, const wire::FrameBegin&) override {
    begun = false;
    return {};
  }
  client::Status on_block(const wire::MessageHeader&, const wire::WedgeBlock& block,
                          std::span<const std::byte>) override {
    if (!std::exchange(begun, true)) first_index = block.wedge_index();
    if (block.wedge_index() == first_index) first_wedge = Clock::now();
    return {};
  }
  client::Status on_end(const wire::MessageHeader&, const wire::FrameEnd&) override {
    ended = true;
    return {};
  }
};

struct Figures {
  double frame_s = 0;
  double first_binned = 0;  // shares of the frame's time, medians
  double first_at_client = 0;
  double first_at_client_p90 = 0;
  double last_byte = 0;
  double last_byte_p90 = 0;
};

/// A server of one radar and a client that is sent every frame of it with all planes, one after the other.
class Watched {
 public:
  Watched(const rendering::FrameRenderer& renderer, const RadarConfig& radar)
      : server_(renderer, {radar}, options()) {
    check(client_.connect({"127.0.0.1", server_.port()}));
    client_.set_handler(&watcher);
    subscription_.set_radar(radar.name);
    subscription_.set_rate_hz(kAny_hz);
    subscription_.set_lossless(true);
    check(client_.subscribe(subscription_));
  }

  void set_rate(double rate_hz) {
    subscription_.set_rate_hz(rate_hz);
    check(client_.unsubscribe(subscription_.radar()));
    check(client_.subscribe(subscription_));
  }
  Clock::time_point next_frame() {
    for (watcher.ended = false; !watcher.ended;) check(client_.receive(kLong));
    return Clock::now();
  }

  Watcher watcher;

 private:
  static constexpr double kAny_hz = 10000;
  static net::ServerOptions options() {
    net::ServerOptions options;
    options.max_rate_hz = kAny_hz;
    return options;
  }

  bench::Served server_;
  client::Client client_;
  wire::Subscribe subscription_;
};

Figures measure(const std::shared_ptr<const Scene>& scene, const RadarConfig& radar, int frames) {
  Moments moments;
  const WatchedRenderer renderer(scene, moments);
  Watched watched(renderer, radar);
  watched.next_frame();
  // So seldom that one frame is over, on both sides, before the next begins.
  const auto start = Clock::now();
  watched.next_frame();
  watched.set_rate(0.4 / seconds_between(start, Clock::now()));
  watched.next_frame();

  std::vector<double> frame_s, first, last, binned;
  for (int n = 0; n < frames; ++n) {
    const auto end = watched.next_frame();
    const auto begin = moments.begin.load();
    frame_s.push_back(seconds_between(begin, end));
    binned.push_back(seconds_between(begin, moments.first_binned) / frame_s.back());
    first.push_back(seconds_between(begin, watched.watcher.first_wedge) / frame_s.back());
    last.push_back(seconds_between(moments.last_binned, end) / frame_s.back());
  }
  return {bench::quantile(frame_s, 0.5), bench::quantile(binned, 0.5), bench::quantile(first, 0.5),
          bench::quantile(first, 0.9),   bench::quantile(last, 0.5),   bench::quantile(last, 0.9)};
}

/// Frames a second of a radar that stands still, as the daemon serves them.
double standing_per_s(const std::shared_ptr<const Scene>& scene, const RadarConfig& radar, int frames) {
  const rendering::SceneRenderer scenes(scene, "hills");
  const rendering::FrameCache renderer(scenes);
  Watched watched(renderer, radar);
  for (int k = 0; k < 4; ++k) watched.next_frame();  // from the third on they are repeated
  const auto start = Clock::now();
  Clock::time_point end;
  for (int k = 0; k < frames; ++k) end = watched.next_frame();
  return frames / seconds_between(start, end);
}

struct Arguments {
  std::string scene;
  LoadOptions options;
  std::string json;
  int frames = 20;
};

void run(const Arguments& arguments) {
  const SceneConfig config = load_scene_file(arguments.scene, arguments.options);
  const auto scene = std::make_shared<const Scene>(std::make_shared<const World>(load_world(config.world)),
                                                   config.materials, 0);
  if (needs_tracer(*scene, RadarSettings{}.frustum)) scene->tracer();  // not while a frame is timed
  RadarConfig radar = choose_radar(config, "");
  std::printf("%d x %d bins, all planes, %d frames each; shares of the frame's time, median (90 %% below)\n",
              radar.settings.azimuth_bins, radar.settings.range_bins, arguments.frames);
  nlohmann::ordered_json report;
  for (const auto& [name, frustum] :
       {std::pair{"default", RadarSettings{}.frustum}, std::pair{"sweep", FrustumKind::sweep}}) {
    radar.settings.frustum = frustum;
    radar.settings.plates = RadarSettings{}.plates;
    const Figures f = measure(scene, radar, arguments.frames);
    std::printf(
        "%-8s frame %7.1f ms; first wedge binned at %.1f %%, at the client at %.1f %% (%.1f %%, target: "
        "below "
        "%.0f %%); last byte %.1f %% (%.1f %%, target: within %.0f %%) after the last wedge was binned\n",
        name, 1000 * f.frame_s, 100 * f.first_binned, 100 * f.first_at_client, 100 * f.first_at_client_p90,
        100 * kFirstTarget, 100 * f.last_byte, 100 * f.last_byte_p90, 100 * kLastTarget);
    const double standing = standing_per_s(scene, radar, 5 * arguments.frames);
    std::printf("%-8s %.1f frames a second while the radar stands still\n", name, standing);
    std::fflush(stdout);
    report[name] = {{"frame_s", f.frame_s},
                    {"standing_frames_per_s", standing},
                    {"first_wedge", f.first_at_client},
                    {"first_wedge_p90", f.first_at_client_p90},
                    {"last_byte", f.last_byte},
                    {"last_byte_p90", f.last_byte_p90}};
  }
  if (!arguments.json.empty())
    write_text(arguments.json, nlohmann::ordered_json{{"frames", arguments.frames},
                                                      {"target_first_wedge", kFirstTarget},
                                                      {"target_last_byte", kLastTarget},
                                                      {"frusta", report}}
                                       .dump(1) +
                                   "\n");
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("How soon a client has something to show");
  app.add_option("SCENE", arguments.scene, "Scene file")->required();
  app.add_option("--set", arguments.options.set, "KEY=VALUE, beats the scene file");
  app.add_option("--frames", arguments.frames, "Of each frustum")->check(CLI::PositiveNumber);
  app.add_option("--json", arguments.json, "File for the figures")->type_name("FILE");
  CLI11_PARSE(app, argc, argv);
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "first_light: %s\n", error.what());
    return 1;
  }
  return 0;
}
