// `obliq pose`: moves the antenna of a live radar.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>

#include "proto/obliq.pb.h"
#include "server/apps/commands.h"
#include "server/apps/server_arguments.h"
#include "server/control/settings_message.h"
#include "terrain/errors.h"

namespace obliq {
namespace {

struct PoseArguments {
  ServerArguments server;
  std::vector<std::string> set;
};

/// Options with a name of their own; each is short for --set antenna.KEY=VALUE.
constexpr std::pair<const char*, const char*> kShortcuts[] = {
    {"--latitude", "antenna.latitude_deg"}, {"--longitude", "antenna.longitude_deg"},
    {"--height", "antenna.height_m"},       {"--height-reference", "antenna.height_reference"},
    {"--bearing", "antenna.bearing_deg"},
};

void run(const PoseArguments& arguments) {
  for (const std::string& flag : arguments.set) {
    if (flag.rfind("antenna.", 0) == 0) continue;
    throw InputError("--set: found " + flag + "; allowed: a pose has keys that begin with antenna.");
  }
  client::Client client = connect_to_server(arguments.server, "obliq pose");
  const std::string radar = choose_remote_radar(client, arguments.server);
  wire::RadarInfo info;
  require(client.get_radar(radar, info));
  if (!arguments.set.empty()) {
    RadarConfig config;
    const auto errors = merge_message(info.pose(), config.pose);
    if (!errors.empty()) throw InputError("the server's radar: " + errors.front().text());
    apply_radar_flags(arguments.set, config);
    ++config.pose.pose_id;
    wire::Pose pose;
    write_message(config.pose, pose);
    wire::Ack ack;
    require(client.claim_control(radar));
    require(client.set_pose(radar, pose, ack));
    require(client.get_radar(radar, info));
    require(client.release_control(radar));
  }
  const wire::Pose& pose = info.pose();
  std::printf("%s: %.7f %c, %.7f %c, %.2f m above %s, bearing %.3f degrees\n", radar.c_str(),
              std::abs(pose.latitude_deg()), pose.latitude_deg() < 0 ? 'S' : 'N',
              std::abs(pose.longitude_deg()), pose.longitude_deg() < 0 ? 'W' : 'E', pose.height_m(),
              pose.height_reference() == wire::GROUND      ? "ground"
              : pose.height_reference() == wire::ELLIPSOID ? "ellipsoid"
                                                           : "datum",
              pose.bearing_deg());
}

}  // namespace

void add_pose(CLI::App& app) {
  CLI::App* command = app.add_subcommand("pose", "Show or set where a server's radar stands and looks");
  auto arguments = std::make_shared<PoseArguments>();
  add_server_arguments(*command, arguments->server);
  command->add_option("--set", arguments->set, "KEY=VALUE, e.g. antenna.bearing_deg=90 (repeatable)")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  for (const auto& [option, key] : kShortcuts) {
    command->add_option_function<std::string>(
        option,
        [arguments, prefix = std::string(key) + "="](const std::string& value) {
          arguments->set.push_back(prefix + value);
        },
        std::string("Short for --set ") + key);
  }
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
