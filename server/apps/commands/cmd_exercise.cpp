// `obliq save`, `load`, `reset` and `freeze`: all radars of a server, as an instructor has them.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/state_file.h"
#include "server/output/frame_files.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

struct ExerciseArguments {
  ServerArguments server;
  std::string file;
  std::string freeze;
};
using ArgumentsPtr = std::shared_ptr<ExerciseArguments>;

client::Client connect(const ExerciseArguments& arguments) {
  client::Client client = connect_to_server(arguments.server, "obliq");
  if (client.welcome().minor() < 2)
    throw InputError("the server speaks version 1." + std::to_string(client.welcome().minor()) +
                     " of the protocol; allowed: 1.2 or later");
  return client;
}

/// Both claims of a radar, or of all (empty). An admin needs none, and the holders keep theirs.
void claim(client::Client& client, const std::string& radar) {
  if (client.welcome().role() == "admin") return;
  for (const std::string& name : client.welcome().radars())
    if (radar.empty() || name == radar) require(client.claim_control(name));
}

/// " and 3 targets"; nothing where the state says nothing of them.
std::string and_targets(const wire::ExerciseState& state) {
  return state.with_targets() ? " and " + std::to_string(state.targets_size()) + " targets" : "";
}

void save(const ExerciseArguments& arguments) {
  client::Client client = connect(arguments);
  wire::ExerciseState state;
  require(client.get_exercise(state));
  write_text(arguments.file, state_text(state));
  std::printf("%s: %d radars%s of %s\n", arguments.file.c_str(), state.radars_size(),
              and_targets(state).c_str(), state.scene_name().c_str());
}

void load(const ExerciseArguments& arguments) {
  const wire::ExerciseState state = read_state_file(arguments.file);
  client::Client client = connect(arguments);
  claim(client, "");
  if (state.with_targets() && client.welcome().role() != "admin") require(client.claim_targets());
  const client::Status status = client.load_exercise(state);
  if (!status.ok()) throw InputError(arguments.file + ": " + status.sentence());
  std::printf("%s: %d radars%s are as they were\n", arguments.file.c_str(), state.radars_size(),
              and_targets(state).c_str());
}

void reset(const ExerciseArguments& arguments) {
  client::Client client = connect(arguments);
  const std::string radar =
      arguments.server.radar.empty() ? "" : choose_remote_radar(client, arguments.server);
  claim(client, radar);
  require(client.reset_exercise(radar));
  std::printf("%s as in the scene file\n", radar.empty() ? "all radars are" : (radar + " is").c_str());
}

void freeze(const ExerciseArguments& arguments) {
  client::Client client = connect(arguments);
  claim(client, "");
  require(client.freeze_exercise(arguments.freeze == "on"));
  std::printf("%s\n", arguments.freeze == "on" ? "all radars stand still" : "all radars go on");
}

CLI::App& add(CLI::App& app, const char* name, const char* text, void (*run)(const ExerciseArguments&),
              const ArgumentsPtr& arguments) {
  CLI::App* command = app.add_subcommand(name, text);
  add_server_arguments(*command, arguments->server);
  command->callback([run, arguments] { run(*arguments); });
  return *command;
}

}  // namespace

void add_exercise(CLI::App& app) {
  const auto saved = std::make_shared<ExerciseArguments>();
  add(app, "save",
      "Write the state of a server's exercise to a file: poses, settings, seeds, times, switches of all "
      "radars",
      save, saved)
      .add_option("STATE", saved->file, "The file, TOML; it names its scene by hash")
      ->required();
  const auto loaded = std::make_shared<ExerciseArguments>();
  add(app, "load",
      "Put a saved state in place, all of it or nothing; needs the role admin, or no other client that holds "
      "a radar",
      load, loaded)
      .add_option("STATE", loaded->file, "A file of `obliq save`, of the scene that is served")
      ->required();
  add(app, "reset",
      "Put radars back to the scene file's settings, pose and switches: that of --radar, or all", reset,
      std::make_shared<ExerciseArguments>());
  const auto frozen = std::make_shared<ExerciseArguments>();
  add(app, "freeze",
      "Stop all radars of a server for all stations, clock, antenna and noise, or let them go on", freeze,
      frozen)
      .add_option("on|off", frozen->freeze, "On: nothing moves until it is off again")
      ->required()
      ->check(CLI::IsMember({"on", "off"}));
}

}  // namespace obliq
