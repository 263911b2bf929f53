#pragma once
// What the commands that talk to a server share.
#include <string>
#include <string_view>
#include <vector>

#include "client/client.h"
#include "server/control/sections/radar.h"

namespace CLI {
class App;
}

namespace obliq {

struct Parameter;

struct ServerArguments {
  std::string server;
  std::string radar;
  client::TlsOptions tls;
  std::string token_file;
  int wait_s = 0;  ///< how long to try again while no server answers
};

/// Adds --server (positional: also as a word of its own), --radar, --tls, --ca, --token-file and --wait.
/// `arguments` must outlive the parsing.
void add_server_arguments(CLI::App& app, ServerArguments& arguments, bool positional = false);

/// Throws InputError unless all went well.
void require(const client::Status& status);

/// Connects, introducing itself by that name; tries again for as long as --wait says, with one line on
/// stderr. Throws InputError.
client::Client connect_to_server(const ServerArguments& arguments, const std::string& name);

/// The named radar, or the server's only one. Throws InputError that lists the names.
std::string choose_remote_radar(const client::Client& client, const ServerArguments& arguments);
/// The same of what SetPose moves: a radar, or a platform that radars ride on.
std::string choose_flown(client::Client& client, const ServerArguments& arguments);

/// The radar as the server has it. Throws InputError.
RadarConfig config_of(const wire::RadarInfo& info);

/// How a command takes KEY=VALUE.
struct FlagRules {
  std::string where = "--set";  ///< what complaints begin with
  /// Why the command has no use for a parameter; empty: it has. Null: for all.
  std::string (*why_not)(const Parameter&) = nullptr;
};

/// Sets radar parameters from KEY=VALUE, with the keys of a scene file. Limits are left to the server, which
/// has the last word anyway. Throws InputError.
void apply_radar_flags(const std::vector<std::string>& flags, RadarConfig& radar,
                       const FlagRules& rules = {});

/// Whether one of KEY=VALUE has that key.
bool names_key(const std::vector<std::string>& flags, std::string_view key);

/// Of a pose that flags have been applied to, the fields that they name; an angle that is "auto" as its flag.
void write_named(const std::vector<std::string>& flags, const PoseSettings& pose, wire::Pose& message);

/// "controlled by X", or "pose held by X, settings by nobody".
std::string holders_text(const std::string& of_pose, const std::string& of_settings);

}  // namespace obliq
