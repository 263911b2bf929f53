#include "server/apps/commands/arguments/server_arguments.h"

#include <fmt/core.h>
#include <google/protobuf/descriptor.h>
#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/scene_arguments.h"
#include "server/control/config_tree.h"
#include "server/control/key_list.h"
#include "server/control/parameters.h"
#include "server/control/planes_per_bin.h"
#include "server/control/quality_presets.h"
#include "server/control/section_reader.h"
#include "server/control/settings_message.h"
#include "server/loading/scene_loading.h"
#include "terrain/base/errors.h"
#include "terrain/base/files.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

constexpr int kMaxWait_s = 86400;
constexpr std::chrono::milliseconds kRetryPause{100};
// obliqd answers a Hello at once. What is silent for longer is told from it, unless --wait has patience.
constexpr client::Timeout kGreeted{2000};
constexpr int kMostTokenLines = 100;
constexpr std::size_t kLongestTokenBytes = 256;

/// A number that may be left to the server, and the switch for that.
struct Automatic {
  std::string_view key;
  std::string_view flag;
};
constexpr Automatic kAutomatic[] = {{"video.floor_db", "video.floor_auto"},
                                    {"antenna.tilt_deg", "antenna.tilt_auto"},
                                    {"sea.state", "sea.state_auto"}};

/// Whether trying again may help. A server that answers, if only with a refusal, is there.
bool may_come_up(client::Outcome outcome) {
  return outcome == client::Outcome::cannot_connect || outcome == client::Outcome::timed_out ||
         outcome == client::Outcome::closed;
}

/// What a key is that is no radar parameter.
std::string why_no_parameter(const std::string& name) {
  constexpr auto kList = "`obliq parameters` lists them";
  std::vector<std::string> names;
  std::vector<std::string> of_scene;
  for (const KeyText& key : all_keys()) {
    const bool of_radar = key.group == KeyGroup::radar || key.group == KeyGroup::short_form;
    (of_radar ? names : of_scene).push_back(key.name);
  }
  if (name == "radar.platform" || name.starts_with("mount."))
    return "can only be set in the scene file, which says what rides on what; allowed: change it there and "
           "start obliqd anew";
  if (name == "beam.file" || name == "radar.preset")
    return "can only be set in the scene file; allowed: change it there and send obliqd a SIGHUP";
  if (std::ranges::find(of_scene, name) != of_scene.end())
    return std::string(
               "belongs to the scene, which obliqd reads when it starts and at SIGHUP; allowed: a "
               "radar parameter; ") +
           kList;
  const std::string near = nearest_name(name, names);
  return "an unknown key; " + (near.empty() ? kList : "did you mean " + near + "?");
}

/// Puts one value in its place, or adds a complaint.
void set_parameter(const std::string& name, const ConfigNode& node, const FlagRules& rules,
                   RadarConfig& radar, Complaints& complaints) {
  const std::string where = rules.where + " " + name;
  const Parameter* parameter = find_parameter(name);
  if (parameter == nullptr) return complaints.add(where + ": " + why_no_parameter(name));
  if (const std::string why = rules.why_not ? rules.why_not(*parameter) : ""; !why.empty())
    return complaints.add(where + ": " + why);
  const Slot slot = parameter->slot(radar);
  if (const auto error = store_node(parameter->key, slot, node))
    complaints.add(fmt::format("{}: found {}; allowed: {}", where, error->found, error->allowed));
}

/// The name of the table of parameters for what may be an alias.
std::string table_name(const std::string& name) {
  const auto* const found = std::ranges::find(kKeyAliases, name, &KeyAlias::alias);
  return found == std::end(kKeyAliases) ? name : std::string(found->name);
}

/// Both names of a parameter with two values.
void check_aliases(const std::vector<std::string>& flags, const std::string& where, Complaints& complaints) {
  const auto text_of = [&](std::string_view key) {
    const auto found = std::ranges::find_if(
        flags, [&](const std::string& flag) { return flag.starts_with(std::string(key) + "="); });
    return found == flags.end() ? std::string() : found->substr(key.size() + 1);
  };
  for (const KeyAlias& each : kKeyAliases) {
    const std::string here = text_of(each.alias);
    const std::string there = text_of(each.name);
    if (!here.empty() && !there.empty() && here != there)
      complaints.add(where,
                     {std::string(each.alias), here + " beside " + std::string(each.name) + " = " + there,
                      std::string(kOneOfTwoNames)});
  }
}

/// The first line that is neither empty nor a comment.
std::string read_token(const std::string& path) {
  refuse_endless_file("--token-file: " + path, path);
  struct stat status {};
  std::ifstream file(path);
  if (!file || ::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode))
    throw InputError("--token-file: " + path + " cannot be read");
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    std::fprintf(stderr, "obliq: warning: %s may be read by other users: chmod 600\n", path.c_str());
  std::string line;
  for (int i = 0; i < kMostTokenLines && std::getline(file, line); ++i) {
    const std::string token(trimmed(line));
    if (token.empty() || token.front() == '#') continue;
    if (token.find_first_of(" \t") == std::string::npos && token.size() <= kLongestTokenBytes) return token;
    break;
  }
  throw InputError("--token-file: " + path + ": found no line that is one token");
}

}  // namespace

void add_server_arguments(CLI::App& app, ServerArguments& arguments, bool positional) {
  app.add_option(positional ? "SERVER,--server" : "--server", arguments.server,
                 "Address of obliqd: HOST:PORT, HOST, :PORT or PORT, [IPv6]:PORT")
      ->type_name("HOST:PORT")
      ->envname("OBLIQ_SERVER")
      ->default_val("127.0.0.1:7420");
  add_radar_argument(app, arguments.radar);
  app.add_flag("--tls", arguments.tls.enabled, "The server speaks TLS");
  app.add_option("--ca", arguments.tls.ca_file,
                 "PEM file of the authorities to trust instead of this machine's; with --tls")
      ->type_name("FILE");
  app.add_option("--token-file", arguments.token_file,
                 "File with the server's token in its first line; its mode should be 600")
      ->type_name("FILE")
      ->envname("OBLIQ_TOKEN_FILE");
  app.add_option("--wait", arguments.wait_s,
                 "Retry for this long while no server answers, as while obliqd loads")
      ->type_name("SECONDS")
      ->default_val(0)
      ->check(whole_number_from(0, kMaxWait_s));
}

void require(const client::Status& status) {
  if (!status.ok()) throw InputError(status.sentence());
}

client::Client connect_to_server(const ServerArguments& arguments, const std::string& name) {
  const auto endpoint = client::parse_endpoint(arguments.server);
  if (!endpoint)
    throw InputError("--server: found \"" + arguments.server +
                     "\"; allowed: HOST:PORT, HOST, :PORT, PORT or [IPv6]:PORT, such as 127.0.0.1:7420");
  if (!arguments.tls.enabled && !arguments.tls.ca_file.empty()) throw InputError("--ca: allowed with --tls");
  client::ClientOptions options{.name = name};
  options.tls = arguments.tls;
  options.hello_timeout =
      std::clamp<client::Timeout>(std::chrono::seconds(arguments.wait_s), kGreeted, options.reply_timeout);
  if (!arguments.token_file.empty()) options.token = read_token(arguments.token_file);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(arguments.wait_s);
  client::Client client;
  bool waiting = false;
  for (;;) {
    client::Status status = client.connect(*endpoint, options);
    if (status.ok()) return client;
    if (!may_come_up(status.outcome) || std::chrono::steady_clock::now() >= end) {
      if (waiting) status.text += fmt::format(" (waited {} s)", arguments.wait_s);
      if (status.outcome == client::Outcome::timed_out)
        status.text += "; --server HOST:PORT gives obliqd's address, --wait SECONDS more time";
      if (status.outcome == client::Outcome::cannot_connect)
        status.text +=
            "; start obliqd there (`obliqd SCENE.toml`), or give its address with --server HOST:PORT; --wait "
            "SECONDS retries until it has loaded";
      require(status);
    }
    if (!waiting)
      std::fprintf(stderr, "obliq: waiting for a server at %s, %d s at most\n", endpoint->text().c_str(),
                   arguments.wait_s);
    waiting = true;
    std::this_thread::sleep_for(kRetryPause);
  }
}

std::string choose_remote_radar(const client::Client& client, const ServerArguments& arguments) {
  const wire::Welcome& welcome = client.welcome();
  std::string names;
  for (const std::string& radar : welcome.radars()) {
    if (is_meant(radar, arguments.radar, static_cast<std::size_t>(welcome.radars_size()))) return radar;
    names += (names.empty() ? "" : ", ") + radar;
  }
  if (names.empty()) throw InputError("the server has no radars");
  throw InputError("--radar: found " + (arguments.radar.empty() ? "nothing" : "\"" + arguments.radar + "\"") +
                   "; allowed: " + names);
}

std::string choose_flown(client::Client& client, const ServerArguments& arguments) {
  const auto& radars = client.welcome().radars();
  const bool is_another = std::ranges::find(radars, arguments.radar) == radars.end();
  wire::RadarList list;
  if (!arguments.radar.empty() && is_another) require(client.list_radars(list));
  if (list.platforms().empty()) return choose_remote_radar(client, arguments);
  std::string names;
  for (const auto& known : {list.radars(), list.platforms()})
    for (const std::string& name : known) {
      if (name == arguments.radar) return name;
      names += (names.empty() ? "" : ", ") + name;
    }
  throw InputError("--radar: found \"" + arguments.radar + "\"; allowed: " + names);
}

RadarConfig config_of(const wire::RadarInfo& info) {
  RadarConfig config;
  config.name = info.radar();
  for (const auto& errors :
       {merge_message(info.settings(), config.settings), merge_message(info.pose(), config.pose)})
    if (!errors.empty()) throw InputError("the server's radar: " + errors.front().text());
  return config;
}

std::string holders_text(const std::string& of_pose, const std::string& of_settings) {
  const auto name = [](const std::string& holder) { return holder.empty() ? "nobody" : holder; };
  if (of_pose == of_settings) return "controlled by " + name(of_pose);
  return "pose held by " + name(of_pose) + ", settings by " + name(of_settings);
}

bool names_key(const std::vector<std::string>& flags, std::string_view key) {
  return std::ranges::any_of(
      flags, [&](const std::string& flag) { return flag.starts_with(std::string(key) + "="); });
}

void write_named(const std::vector<std::string>& flags, const PoseSettings& pose, wire::Pose& message) {
  wire::Pose all;
  write_message(pose, all);
  RadarConfig named{"", {}, pose};
  const google::protobuf::Reflection& reflection = *all.GetReflection();
  bool opens = false;  // a velocity that was given
  for (const Parameter& parameter : parameters()) {
    if (parameter.message != WireMessage::pose) continue;
    const bool is_named = names_key(flags, parameter.key.name);
    if (is_named && !is_left_open(parameter.slot(named))) continue;
    opens |= is_named;
    reflection.ClearField(&all, all.GetDescriptor()->FindFieldByName(std::string(parameter.wire_field)));
  }
  // A number ends "auto" by itself; "auto" is no number.
  if (all.has_tilt_deg() && pose.tilt_auto) {
    all.clear_tilt_deg();
    all.set_tilt_auto(true);
  }
  if (opens) all.set_latitude_deg(pose.latitude_deg);  // a place without a velocity ends it
  message = all;
}

void apply_radar_flags(const std::vector<std::string>& flags, RadarConfig& radar, const FlagRules& rules) {
  Complaints complaints;
  const bool follows = radar.pose.heading_deg == radar.pose.bearing_deg;
  check_aliases(flags, rules.where, complaints);
  std::vector<std::string> ordered = flags;
  std::stable_partition(ordered.begin(), ordered.end(), [](const std::string& flag) {
    return flag.starts_with("frustum.quality=");  // first: a key of its own beats it
  });
  // What gives the pixels that no flag names, once all bins are known.
  const QualityPreset* of_columns = nullptr;
  const QualityPreset* of_rows = nullptr;
  const QualityPreset* of_planes = nullptr;
  bool columns_named = false;
  for (const std::string& flag : ordered) {
    const std::size_t equals = flag.find('=');
    if (equals == std::string::npos || equals == 0) {
      complaints.add(rules.where + ": found \"" + flag +
                     "\"; allowed: KEY=VALUE, such as radar.r_max_m=37000");
      continue;
    }
    const std::string name = table_name(flag.substr(0, equals));
    const ConfigNode node =
        parse_config_value(std::string_view(flag).substr(equals + 1), rules.where + " " + name);
    const auto set = [&](const std::string& key, const ConfigNode& value) {
      if (key == "frustum.pixel_columns") {
        of_columns = nullptr;
        columns_named = true;
      }
      if (key == "frustum.planes_per_bin") of_planes = nullptr;
      if (key == "frustum.pixel_rows") of_rows = nullptr;
      set_parameter(key, value, rules, radar, complaints);
    };
    // What may be "auto", as in a scene file: a number ends it.
    if (const auto automatic = std::ranges::find(kAutomatic, name, &Automatic::key);
        automatic != std::end(kAutomatic)) {
      const auto* text = std::get_if<std::string>(&node.value);
      const bool is_auto = text != nullptr && *text == "auto";
      ConfigNode decided = node;
      decided.value = is_auto;
      if (!is_auto) set(name, node);
      if (is_auto || !names_key(flags, automatic->flag)) set(std::string(automatic->flag), decided);
      continue;
    }
    // The short forms, as in a scene file.
    if (name == "frustum.pixels") {
      const bool pair = node.kind == ConfigNode::Kind::array && node.items.size() == 2;
      set("frustum.pixel_columns", pair ? node.items[0] : node);
      set("frustum.pixel_rows", pair ? node.items[1] : node);
    } else if (name == "frustum.quality") {
      const auto* text = std::get_if<std::string>(&node.value);
      const QualityPreset* preset = text != nullptr ? find_quality(*text) : nullptr;
      if (preset == nullptr) {
        complaints.add(rules.where, {name, node.found_text(), choices_text(quality_choices())});
        continue;
      }
      if (preset->searched) {
        complaints.add("--set",
                       {name, node.found_text() + ", whose pixels obliqd finds for radars of its scene file",
                        "frustum.kind=oblique with frustum.pixels, or another quality"});
        continue;
      }
      ConfigNode value = node;
      value.value = std::string(preset->kind);
      set("frustum.kind", value);
      value.value = std::string(preset->plates);
      set("frustum.plates", value);
      of_columns = of_rows = of_planes = preset;
    } else {
      set(name, node);
    }
  }
  // As in a scene file: a heading that is not named is the bearing.
  if (follows && !names_key(flags, "antenna.heading_deg")) radar.pose.heading_deg = radar.pose.bearing_deg;
  RadarSettings& settings = radar.settings;
  if (of_columns != nullptr) settings.pixel_columns = of_columns->columns_for(settings.azimuth_bins);
  if (of_planes != nullptr) settings.planes_per_bin = of_planes->planes_for(settings.azimuth_bins);
  settle_planes(settings, columns_named);
  if (of_rows != nullptr) settings.pixel_rows = of_rows->rows_for(settings.range_bins);
  complaints.throw_if_any();
}

}  // namespace obliq
