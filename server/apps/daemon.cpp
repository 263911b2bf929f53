#include "server/apps/daemon.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <csignal>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/apps/meet_accuracy.h"
#include "server/apps/scene_loading.h"
#include "server/apps/server_options.h"
#include "server/net/reserved_port.h"
#include "server/net/scene_renderer.h"
#include "server/net/security.h"
#include "server/net/server.h"
#include "terrain/errors.h"

namespace obliq {
namespace {

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

extern "C" void end_while_loading(int) {
  constexpr std::string_view kLine = "obliqd: stopping while loading\n";
  (void)!write(STDERR_FILENO, kLine.data(), kLine.size());  // nobody is left to be told if that fails
  _exit(0);
}

}  // namespace

void heed_signals_while_loading() {
  struct sigaction action {};
  action.sa_handler = end_while_loading;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) {
    if (sigaction(signal, &action, nullptr) != 0) spdlog::warn("signal {} cannot be handled", signal);
  }
}

void run_daemon(SceneConfig config) {
  net::ServerOptions options = server_options(config);
  check_server_protection(config.server, "server.address", options.address);
  options.security = server_security(config.server);
  for (const std::string& warning : options.security->warnings()) spdlog::warn("{}", warning);
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

}  // namespace obliq
