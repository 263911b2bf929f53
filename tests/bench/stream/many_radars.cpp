// Many radars over one scene, from light load to twice what the machine can do: how late their frames are,
// how many are shed, and whether one radar that is twenty times as slow takes anything from the others. A
// server with the real renderer; each radar has a client of its own on the loopback that checks every
// message.
//   many_radars SCENE.toml [--set KEY=VALUE] [--radars N] [--bins N] [--frames N] [--seconds S] [--json FILE]
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "client/client.h"
#include "proto/obliq.pb.h"
#include "server/control/scene_file.h"
#include "server/loading/scene_loading.h"
#include "server/output/frame_files.h"
#include "server/radar/frame_plan.h"
#include "server/rendering/scene_renderer.h"
#include "server/stream/frame_encoder.h"
#include "tests/bench/numbers.h"
#include "tests/bench/stream/served.h"

namespace {

using namespace obliq;
using Clock = std::chrono::steady_clock;
constexpr int kSlower = 20;
constexpr double kLoads[] = {0.25, 0.5, 0.75, 1.0, 1.5, 2.0};  // of the frames that there is time for

struct Arguments {
  std::string scene;
  LoadOptions options;
  std::string json;
  int radars = 16;
  int bins = 512;
  int frames = 30;
  double seconds = 60;
};

void check(const client::Status& status) {
  if (!status.ok()) throw std::runtime_error(status.sentence());
}

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

/// Of one radar in one run.
struct Seen : client::FrameHandler {
  std::vector<double> latency_s;  ///< from a frame's date to its last byte at the client
  std::vector<double> render_s;
  std::int64_t render_start_ns = 0;

  client::Status on_block(const wire::MessageHeader&, const wire::WedgeBlock& block,
                          std::span<const std::byte>) override {
    render_start_ns = block.render_start_ns();
    return {};
  }
  client::Status on_end(const wire::MessageHeader&, const wire::FrameEnd& end) override {
    latency_s.push_back(end.waited_s() +
                        1e-9 * static_cast<double>(stream::monotonic_ns() - render_start_ns));
    render_s.push_back(end.render_s());
    return {};
  }
};

/// A client that watches one radar in a thread of its own.
class Watching {
 public:
  /// Begins `after_s` later, so that not all radars' frames have the same dates.
  Watching(std::uint16_t port, const std::string& radar, double rate_hz, double seconds, double after_s = 0)
      : thread_([this, port, radar, rate_hz, seconds, after_s] {
          std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
          client::Client client;
          check(client.connect({"127.0.0.1", port}));
          client.set_handler(&seen);
          wire::Subscribe subscription;
          subscription.set_radar(radar);
          subscription.set_rate_hz(rate_hz);
          subscription.add_planes(wire::IQ);
          check(client.subscribe(subscription));
          const auto start = Clock::now();
          while (seconds_between(start, Clock::now()) < seconds) {
            const client::Status status = client.receive(client::Timeout(200));
            if (status.outcome != client::Outcome::timed_out) check(status);
          }
        }) {}

  void join() { thread_.join(); }
  Seen seen;

 private:
  std::jthread thread_;
};

struct Row {
  double load = 0;
  double rate_hz = 0;
  int asked = 0;  // frames of all radars but the slow one
  int delivered = 0;
  std::uint64_t shed = 0;
  double p50_s = 0;
  double p99_s = 0;
  double least_share = 0;  // frames of the radar that got least, over those of the one that got most
  int slow_delivered = -1;
  std::uint64_t slow_shed = 0;
};

std::vector<RadarConfig> radars_of(const SceneConfig& config, const Arguments& arguments, bool one_slow) {
  std::vector<RadarConfig> radars;
  for (int k = 0; k < arguments.radars; ++k) {
    RadarConfig radar = choose_radar(config, "");
    radar.name = "radar" + std::to_string(k);
    radar.settings.frustum = FrustumKind::sweep;
    radar.settings.azimuth_bins = radar.settings.range_bins = arguments.bins;
    radar.settings.pixel_columns = arguments.bins * (one_slow && k == 0 ? kSlower : 1);
    radar.pose.height_m += 10 * k;
    radars.push_back(radar);
  }
  return radars;
}

net::ServerOptions options_of(const Arguments& arguments) {
  net::ServerOptions options;
  options.max_rate_hz = 10000;
  options.max_clients = options.max_clients_per_address = 2 * arguments.radars + 2;
  return options;
}

/// What the first radar's frame takes when it has the machine for itself.
double frame_alone_s(const rendering::FrameRenderer& renderer, const std::vector<RadarConfig>& radars,
                     const Arguments& arguments) {
  const bench::Served server(renderer, radars, options_of(arguments));
  Watching watching(server.port(), radars.front().name, 10000, std::min(5.0, arguments.seconds));
  watching.join();
  return bench::quantile(watching.seen.render_s, 0.5);
}

Row measure(const rendering::FrameRenderer& renderer, const std::vector<RadarConfig>& radars, double load,
            double rate_hz, bool one_slow, const Arguments& arguments) {
  const bench::Served server(renderer, radars, options_of(arguments));
  std::vector<std::unique_ptr<Watching>> clients;
  const double seconds = std::min(arguments.seconds, arguments.frames / rate_hz);
  for (const RadarConfig& radar : radars) {
    const double after_s = static_cast<double>(clients.size()) / (rate_hz * arguments.radars);
    clients.push_back(std::make_unique<Watching>(server.port(), radar.name, rate_hz, seconds, after_s));
  }
  client::Client observer;
  check(observer.connect({"127.0.0.1", server.port()}));
  for (const auto& client : clients) client->join();
  wire::Status status;
  check(observer.get_status(status));

  Row row{.load = load, .rate_hz = rate_hz};
  std::vector<double> latency_s;
  double least = 1e30, most = 0;
  for (int k = 0; k < arguments.radars; ++k) {
    const Seen& seen = clients[static_cast<std::size_t>(k)]->seen;
    const auto shed = status.radars(k).frames_shed();
    const auto delivered = static_cast<int>(seen.latency_s.size());
    if (one_slow && k == 0) {
      row.slow_delivered = delivered;
      row.slow_shed = shed;
      continue;
    }
    row.asked += static_cast<int>(std::ceil(rate_hz * seconds));
    row.delivered += delivered;
    row.shed += shed;
    // Of the first frame the server does not know what it costs.
    if (delivered > 0) latency_s.insert(latency_s.end(), seen.latency_s.begin() + 1, seen.latency_s.end());
    least = std::min<double>(least, delivered);
    most = std::max<double>(most, delivered);
  }
  row.p50_s = bench::quantile(latency_s, 0.5);
  row.p99_s = bench::quantile(latency_s, 0.99);
  row.least_share = most > 0 ? least / most : 0;
  return row;
}

nlohmann::ordered_json to_json(const Row& row) {
  nlohmann::ordered_json out{{"load", row.load},   {"rate_hz", row.rate_hz},
                             {"asked", row.asked}, {"delivered", row.delivered},
                             {"shed", row.shed},   {"p50_s", row.p50_s},
                             {"p99_s", row.p99_s}, {"least_over_most", row.least_share}};
  if (row.slow_delivered >= 0) {
    out["slow_delivered"] = row.slow_delivered;
    out["slow_shed"] = row.slow_shed;
  }
  return out;
}

void run(const Arguments& arguments) {
  const SceneConfig config = load_scene_file(arguments.scene, arguments.options);
  const auto scene = std::make_shared<const Scene>(std::make_shared<const World>(load_world(config.world)),
                                                   config.materials, 0);
  if (needs_tracer(*scene, FrustumKind::oblique)) scene->tracer();  // not while frames are timed
  const rendering::SceneRenderer renderer(scene, config.name);
  nlohmann::ordered_json report{{"radars", arguments.radars}, {"bins", arguments.bins}, {"slower", kSlower}};
  const double frame_s = frame_alone_s(renderer, radars_of(config, arguments, false), arguments);
  const double slow_s = frame_alone_s(renderer, radars_of(config, arguments, true), arguments);
  report["frame_s"] = frame_s;
  report["slow_frame_s"] = slow_s;
  std::printf(
      "%d radars of %d x %d bins, I&Q alone; a frame alone takes %.1f ms, radar0's %.1f ms "
      "when it is slow\n",
      arguments.radars, arguments.bins, arguments.bins, 1000 * frame_s, 1000 * slow_s);
  for (const bool one_slow : {false, true}) {
    std::printf(
        "%s\n%6s %9s %7s %10s %6s %9s %9s %11s%s\n",
        one_slow ? "radar0 with twenty times as many planes; the figures are of the others:" : "all alike:",
        "load", "rate Hz", "asked", "delivered", "shed", "p50 ms", "p99 ms", "least/most",
        one_slow ? "  radar0 delivered, shed" : "");
    auto& rows = report[one_slow ? "one_slow" : "all_alike"] = nlohmann::ordered_json::array();
    for (const double load : kLoads) {
      const double rate_hz = load / (frame_s * arguments.radars);
      const Row row =
          measure(renderer, radars_of(config, arguments, one_slow), load, rate_hz, one_slow, arguments);
      std::printf("%6.2f %9.2f %7d %10d %6llu %9.1f %9.1f %11.2f", row.load, row.rate_hz, row.asked,
                  row.delivered, static_cast<unsigned long long>(row.shed), 1000 * row.p50_s,
                  1000 * row.p99_s, row.least_share);
      if (one_slow)
        std::printf("  %d, %llu", row.slow_delivered, static_cast<unsigned long long>(row.slow_shed));
      std::printf("\n");
      std::fflush(stdout);
      rows.push_back(to_json(row));
    }
  }
  if (!arguments.json.empty()) write_text(arguments.json, report.dump(1) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Many radars over one scene");
  app.add_option("SCENE", arguments.scene, "Scene file")->required();
  app.add_option("--set", arguments.options.set, "KEY=VALUE, beats the scene file");
  app.add_option("--radars", arguments.radars, "How many")->check(CLI::Range(2, 100));
  app.add_option("--bins", arguments.bins, "Azimuth and range bins of each")->check(CLI::PositiveNumber);
  app.add_option("--frames", arguments.frames, "Asked of each radar in each row")->check(CLI::PositiveNumber);
  app.add_option("--seconds", arguments.seconds, "For each row, at most")->check(CLI::PositiveNumber);
  app.add_option("--json", arguments.json, "File for the figures")->type_name("FILE");
  CLI11_PARSE(app, argc, argv);
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "many_radars: %s\n", error.what());
    return 1;
  }
  return 0;
}
