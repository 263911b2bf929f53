// `obliq pose`: moves the antenna of a live radar.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/frame_report.h"
#include "server/apps/scene_arguments.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/loading/scene_loading.h"
#include "terrain/base/errors.h"

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
    {"--bearing", "antenna.bearing_deg"},   {"--tilt", "antenna.tilt_deg"},
    {"--heading", "antenna.heading_deg"},   {"--roll", "antenna.roll_deg"},
    {"--pitch", "antenna.pitch_deg"},
};

std::string why_not_a_pose(const Parameter& parameter) {
  if (parameter.message == WireMessage::pose) return {};
  return "is a setting; allowed: keys that begin with antenna.; settings are changed by `obliq set " +
         std::string(parameter.key.name) + "=VALUE`";
}

void run(const PoseArguments& arguments) {
  RadarConfig unused;
  apply_radar_flags(arguments.set, unused,
                    {.why_not = why_not_a_pose});  // mistakes are told without a server
  client::Client client = connect_to_server(arguments.server, "obliq pose");
  const std::string radar = choose_flown(client, arguments.server);
  wire::RadarInfo info;
  require(client.get_radar(radar, info));
  if (!arguments.set.empty()) {
    RadarConfig config;
    const auto errors = merge_message(info.pose(), config.pose);
    if (!errors.empty()) throw InputError("the server's radar: " + errors.front().text());
    apply_radar_flags(arguments.set, config);
    wire::Pose pose;
    write_named(arguments.set, config.pose, pose);
    // A radar on a platform is not moved by itself; the holder of its settings turns its antenna.
    const bool rides = !info.platform().empty();
    if (!pose.has_pose_id() && !rides) pose.set_pose_id(config.pose.pose_id + 1);
    wire::Ack ack;
    client::Status claimed = client.claim(radar, rides ? wire::kSettingsClaim : wire::kPoseClaim);
    if (!claimed.ok() && !rides && names_key(arguments.set, "antenna.tilt_deg"))
      claimed.text += "; tilt alone: `obliq set antenna.tilt_deg=DEGREES`, which takes the settings";
    require(claimed);
    require(client.set_pose(radar, pose, ack));
    for (const std::string& warning : ack.warnings()) say_on_terminal({warning, true});
    require(client.get_radar(radar, info));
    require(client.release_control(radar));
  }
  std::printf("%s: %s\n", radar.c_str(), pose_text(info.pose()).c_str());
}

}  // namespace

void add_pose(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "pose", "Show or set the pose of a server's radar, or of a platform that radars ride on");
  auto arguments = std::make_shared<PoseArguments>();
  add_server_arguments(*command, arguments->server, true);
  add_repeatable(*command, "--set", arguments->set, "KEY=VALUE, e.g. antenna.bearing_deg=90 (repeatable)");
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
