// The daemon: loads a scene and serves its radars.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <iostream>
#include <memory>
#include <string_view>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/apps/meet_accuracy.h"
#include "server/apps/scene_arguments.h"
#include "server/apps/scene_loading.h"
#include "server/net/reserved_port.h"
#include "server/net/scene_renderer.h"
#include "server/net/server.h"
#include "terrain/errors.h"

namespace {

using namespace obliq;

/// A log line per stage and quarter.
Progress log_progress() {
  struct Last {
    std::string stage;
    int quarter = 0;
  };
  return [last = std::make_shared<Last>()](std::string_view stage, double fraction) {
    const int quarter = static_cast<int>(fraction * 4);
    if (stage == last->stage && quarter <= last->quarter) return;
    *last = {std::string(stage), quarter};
    spdlog::info("{}: {} %", stage, 25 * quarter);
  };
}

/// A radar that cannot be rendered as it is configured is a mistake to hear of now, not from a client.
void check_radar(const net::FrameRenderer& renderer, const RadarConfig& radar) {
  const auto snapshot = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{radar.settings, 1});
  const auto plan = renderer.plan(snapshot, radar.pose);
  if (!plan.frame) throw InputError("radar \"" + radar.name + "\": " + all_text(plan.errors));
  wire::FrameDescriptor descriptor;
  plan.frame->describe(radar.name, descriptor);
  for (const std::string& warning : descriptor.warnings()) spdlog::warn("radar {}: {}", radar.name, warning);
}

net::ServerOptions options_of(const SceneConfig& config) {
  net::ServerOptions options;
  options.address = config.server.address;
  options.port = static_cast<std::uint16_t>(config.server.port);
  options.server_version = OBLIQ_VERSION;
  options.scene_name = config.name;
  options.max_clients = config.server.max_clients;
  options.max_request_bytes = static_cast<std::uint32_t>(config.server.max_request_bytes);
  options.handshake_timeout_s = config.server.handshake_timeout_s;
  options.max_bins = config.server.max_bins;
  options.queue_frames = config.server.queue_frames;
  options.render_threads = config.threads;
  options.stop_on_signals = true;
  return options;
}

extern "C" void end_while_loading(int) {
  constexpr std::string_view kLine = "obliqd: stopping while loading\n";
  (void)!write(STDERR_FILENO, kLine.data(), kLine.size());  // nobody is left to be told if that fails
  _exit(0);
}

/// Until the server takes over, SIGINT and SIGTERM end the process at once: there is nothing to lose yet.
/// Also where they were ignored at the start, as by a script's `obliqd &`, since the server will heed them
/// too.
void heed_signals_while_loading() {
  struct sigaction action {};
  action.sa_handler = end_while_loading;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) {
    if (sigaction(signal, &action, nullptr) != 0) spdlog::warn("signal {} cannot be handled", signal);
  }
}

void serve(SceneConfig config) {
  const net::ServerOptions options = options_of(config);
  net::ReservedPort port(options.address, options.port);
  const auto say = [](const std::string& line) { spdlog::info("{}", line); };
  meet_accuracy(config, say, log_progress());
  const net::SceneRenderer renderer(build_scene(config, say, log_progress()), config.name);
  for (const RadarConfig& radar : config.radars) check_radar(renderer, radar);
  net::Server server(renderer, config.radars, options, std::move(port));
  std::string names;
  for (const RadarConfig& radar : config.radars) names += (names.empty() ? "" : ", ") + radar.name;
  spdlog::info("ready: {} on {}", names, server.address());
  server.run();
  spdlog::info("stopped");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Serves radar ground maps of real terrain over TCP. The port is taken at once; until the terrain is "
      "loaded "
      "connections are refused (`obliq get --wait SECONDS` tries again).",
      "obliqd"};
  app.set_version_flag("--version", "obliqd " OBLIQ_VERSION);
  SceneArguments arguments;
  add_scene_arguments(app, "--config", arguments);
  const auto setting = [&](const char* key) {
    return [&arguments, key](const std::string& value) {
      arguments.set.push_back(std::string(key) + "=" + value);
    };
  };
  app.add_option_function<std::string>("--port", setting("server.port"), "Short for --set server.port");
  app.add_option_function<std::string>("--address", setting("server.address"),
                                       "Short for --set server.address");
  spdlog::set_default_logger(spdlog::stderr_color_mt("obliqd"));
  spdlog::flush_on(spdlog::level::info);
  heed_signals_while_loading();
  try {
    app.parse(argc, argv);
    auto config = open_scene(arguments);
    if (config) serve(std::move(*config));
    std::cout.flush();
    return std::cout ? 0 : 1;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::cerr << "obliqd: " << e.what() << " (`obliqd --help` lists what there is)\n";
  } catch (const std::exception& e) {
    std::cerr << "obliqd: " << e.what() << '\n';
  }
  return 1;
}
