// `obliq set`: changes the settings of a live radar, or shows those in effect.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

struct SetArguments {
  ServerArguments server;
  std::vector<std::string> settings;  ///< KEY=VALUE
  std::string transmit;               ///< "on", "off" or nothing
  std::string freeze;
  bool json = false;
};

/// A radar as a server describes it.
struct Shown {
  wire::RadarInfo info;
  RadarConfig config;
};

const char* on_off(bool on) { return on ? "on" : "off"; }

std::optional<bool> is_on(const std::string& word) {
  if (word.empty()) return std::nullopt;
  return word == "on";
}

/// Why a parameter is nothing that this command can set; empty: it can.
std::string why_not_set(const Parameter& parameter) {
  const std::string name(parameter.key.name);
  if (parameter.message == WireMessage::pose && !parameter.meaning.aim)
    return "says where the radar stands; allowed: a setting, antenna.bearing_deg, antenna.tilt_deg; poses "
           "are set by `obliq pose --set " +
           name + "=VALUE` and `obliq fly`";
  if (parameter.change == Change::restart)
    return "is read once, when obliqd starts; allowed: a live setting; change the scene file and restart "
           "obliqd";
  return {};
}

/// Whether KEY=VALUE is of the pose: where the antenna looks.
bool names_aim(const std::string& flag) { return flag.starts_with("antenna."); }

Shown look(client::Client& client, const std::string& radar) {
  Shown shown;
  require(client.get_radar(radar, shown.info));
  shown.config = config_of(shown.info);
  return shown;
}

void print_line(std::string_view name, const std::string& value, const std::string& comment) {
  const std::string line = std::string(name) + " = " + value;
  if (comment.empty())
    std::printf("%s\n", line.c_str());
  else
    std::printf("%-40s  # %s\n", line.c_str(), comment.c_str());
}

void print_notes(const wire::RadarInfo& info) {
  if (info.transmit_off()) std::printf("# transmit is off: no frames until `obliq set --transmit on`\n");
  if (info.frozen())
    std::printf("# frozen: frames keep older settings and an older pose until `obliq set --freeze off`\n");
  if (!info.fault().empty()) std::printf("# cannot be rendered as it is: %s\n", info.fault().c_str());
}

void print_all(const Shown& shown) {
  std::printf("# %s: settings %llu, %s\n", shown.config.name.c_str(),
              static_cast<unsigned long long>(shown.info.settings_version()),
              holders_text(shown.info.controller(), shown.info.settings_controller()).c_str());
  print_line("transmit", std::string("\"") + on_off(!shown.info.transmit_off()) + "\"", "");
  print_line("freeze", std::string("\"") + on_off(shown.info.frozen()) + "\"", "");
  for (const Parameter& parameter : parameters())
    print_line(parameter.key.name, toml_text(value_of(parameter, shown.config)),
               std::string(parameter.key.unit));
  print_notes(shown.info);
}

nlohmann::ordered_json json_of(const Value& value) {
  return std::visit([](const auto& held) -> nlohmann::ordered_json { return held; }, value);
}

void print_json(const Shown& shown) {
  nlohmann::ordered_json root;
  root["radar"] = shown.config.name;
  root["settings_version"] = shown.info.settings_version();
  root["controller"] = shown.info.controller();
  root["settings_controller"] = shown.info.settings_controller();
  root["transmit"] = !shown.info.transmit_off();
  root["freeze"] = shown.info.frozen();
  root["fault"] = shown.info.fault();
  for (const Parameter& parameter : parameters())
    root[parameter.message == WireMessage::pose ? "pose" : "settings"][std::string(parameter.key.name)] =
        json_of(value_of(parameter, shown.config));
  std::printf("%s\n", root.dump(1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

void print_changes(const Shown& before, const Shown& after, const std::vector<std::string>& flags) {
  std::printf("# %s: settings %llu\n", after.config.name.c_str(),
              static_cast<unsigned long long>(after.info.settings_version()));
  bool changed = false;
  const auto compare = [&](std::string_view name, const std::string& was, const std::string& is) {
    if (was == is) return;
    changed = true;
    print_line(name, is, "was " + was);
  };
  compare("transmit", on_off(!before.info.transmit_off()), on_off(!after.info.transmit_off()));
  compare("freeze", on_off(before.info.frozen()), on_off(after.info.frozen()));
  for (const Parameter& parameter : parameters())
    if (parameter.message == WireMessage::radar_settings || names_key(flags, parameter.key.name))
      compare(parameter.key.name, toml_text(value_of(parameter, before.config)),
              toml_text(value_of(parameter, after.config)));
  if (!changed) std::printf("# all of it was so already\n");
  print_notes(after.info);
}

void run(const SetArguments& arguments) {
  const FlagRules rules{"set", why_not_set};
  RadarConfig unused;
  apply_radar_flags(arguments.settings, unused, rules);  // mistakes of the line are told without a server
  client::Client client = connect_to_server(arguments.server, "obliq set");
  const std::string radar = choose_remote_radar(client, arguments.server);
  const std::optional<bool> transmit = is_on(arguments.transmit);
  const std::optional<bool> freeze = is_on(arguments.freeze);
  const bool changes = !arguments.settings.empty() || transmit || freeze;
  // The holder of the pose keeps it.
  if (changes) require(client.claim(radar, wire::kSettingsClaim));
  const Shown before = look(client, radar);
  if (!arguments.settings.empty()) {
    RadarConfig wanted = before.config;
    apply_radar_flags(arguments.settings, wanted, rules);
    wire::Pose aim;
    write_named(arguments.settings, wanted.pose, aim);
    wire::Ack ack;
    if (!std::ranges::all_of(arguments.settings, names_aim)) {
      wire::RadarSettings settings;
      write_request(wanted.settings, settings);
      require(client.set_settings(radar, settings, ack));
    }
    if (aim.ByteSizeLong() > 0) require(client.set_pose(radar, aim, ack));
  }
  if (transmit || freeze) require(client.set_state(radar, transmit, freeze));
  if (changes) require(client.release_control(radar));
  const Shown after = changes ? look(client, radar) : before;
  if (arguments.json) {
    print_json(after);
  } else if (changes) {
    print_changes(before, after, arguments.settings);
  } else {
    print_all(after);
  }
}

}  // namespace

void add_set(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "set", "Change the settings of a server's radar while it runs, or show those in effect");
  auto arguments = std::make_shared<SetArguments>();
  add_server_arguments(*command, arguments->server);
  command
      ->add_option(
          "SETTING", arguments->settings,
          "KEY=VALUE (repeatable), applied together or not at all, e.g. radar.r_max_m=20000 (`obliq "
          "parameters` lists them); then antenna.tilt_deg and antenna.bearing_deg, which counts from "
          "the heading while another client flies the radar. None: the settings in effect are printed")
      ->type_name("KEY=VALUE");
  const CLI::Validator on_or_off{
      [](std::string& found) {
        return found == "on" || found == "off" ? "" : "found \"" + found + "\"; allowed: on, off";
      },
      ""};
  command
      ->add_option("--transmit", arguments->transmit,
                   "Off: the radar is not rendered, its watchers stay and get no frames")
      ->type_name("on|off")
      ->check(on_or_off);
  command
      ->add_option("--freeze", arguments->freeze,
                   "On: frames keep the settings and the pose of this moment until it is off again")
      ->type_name("on|off")
      ->check(on_or_off);
  command->add_flag("--json", arguments->json, "Print all settings in effect as JSON");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
