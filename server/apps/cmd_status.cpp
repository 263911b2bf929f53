// `obliq status`: what a server is doing.
#include <CLI/CLI.hpp>
#include <cinttypes>
#include <cstdio>
#include <memory>

#include "proto/obliq.pb.h"
#include "server/apps/commands.h"
#include "server/apps/server_arguments.h"

namespace obliq {
namespace {

void run(const ServerArguments& arguments) {
  client::Client client = connect_to_server(arguments, "obliq status");
  if (!arguments.radar.empty()) (void)choose_remote_radar(client, arguments);
  wire::Status status;
  require(client.get_status(status));
  std::printf("%s %s, scene %s, up %.0f s, %u client%s, %.1f MB sent, %" PRIu64
              " frames dropped, %u renders queued\n",
              status.server_name().c_str(), status.server_version().c_str(),
              client.welcome().scene_name().c_str(), status.uptime_s(), status.clients(),
              status.clients() == 1 ? "" : "s", static_cast<double>(status.bytes_sent()) * 1e-6,
              status.frames_dropped(), status.renders_queued());
  if (status.windows_loaded() > 0 || status.window_failures() > 0 || status.window_loading()) {
    std::printf("terrain: %" PRIu64 " loaded since the start, %" PRIu64 " could not be%s%s%s\n",
                status.windows_loaded(), status.window_failures(),
                status.window_loading() ? ", one is being loaded" : "",
                status.window_error().empty() ? "" : "; the last: ", status.window_error().c_str());
  }
  for (const wire::RadarStatus& radar : status.radars()) {
    if (!arguments.radar.empty() && radar.radar() != arguments.radar) continue;
    std::printf("%s: settings %" PRIu64 ", controlled by %s, %u watching at %g Hz, %" PRIu64 " frames",
                radar.radar().c_str(), radar.settings_version(),
                radar.controller().empty() ? "nobody" : radar.controller().c_str(), radar.subscribers(),
                radar.rate_hz(), radar.frames());
    if (radar.frames() > 0) std::printf(", the last in %.1f ms", 1000 * radar.last_render_s());
    if (radar.frames_shed() > 0) std::printf(", %" PRIu64 " shed for want of time", radar.frames_shed());
    if (radar.pose_stale()) std::printf(", its pose is stale");
    if (radar.late_poses() > 0) std::printf(", %" PRIu64 " poses came late", radar.late_poses());
    if (radar.dwells_missed() > 0) std::printf(", %" PRIu64 " dwells missed", radar.dwells_missed());
    if (!radar.fault().empty()) std::printf(", cannot be rendered: %s", radar.fault().c_str());
    std::printf("\n");
  }
}

}  // namespace

void add_status(CLI::App& app) {
  CLI::App* command = app.add_subcommand("status", "Show what a server is doing");
  auto arguments = std::make_shared<ServerArguments>();
  add_server_arguments(*command, *arguments);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
